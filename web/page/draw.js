// Draws a moment of a recording from above.
import { shaded } from "./relief.js";

export class View {
  constructor(canvas) {
    this.canvas = canvas;
    this.context = canvas.getContext("2d");
    this.centre = [0, 0];
    this.scale = 100;
    this.colours = {};
    this.scenery = null;
  }

  // Takes size and colours from the page.
  fitCanvas() {
    const { clientWidth: width, clientHeight: height } = this.canvas, ratio = window.devicePixelRatio || 1;
    if (this.canvas.width !== Math.round(width * ratio) || this.canvas.height !== Math.round(height * ratio)) {
      this.canvas.width = Math.round(width * ratio);
      this.canvas.height = Math.round(height * ratio);
    }
    [this.width, this.height, this.ratio] = [width, height, ratio];
  }

  readColours() {
    const style = getComputedStyle(document.documentElement);
    for (const name of ["page", "floor", "grid", "wall", "ink", "soft", "lidar", "psd", "belief", "goal", "bad", "accent", "panel", "water"]) {
      this.colours[name] = style.getPropertyValue(`--${name}`).trim();
    }
    this.colours.robots = ["robot", "robot-2", "robot-3", "robot-4", "robot-5", "robot-6"]
      .map((name) => style.getPropertyValue(`--${name}`).trim());
  }

  // Shows a box of the world: [left, bottom, right, top] in metres.
  show(box) {
    this.fitCanvas();
    // The buttons of the view stand on the right, or above where the page is narrow.
    const narrow = this.width < 560, margin = narrow ? 20 : 40, right = narrow ? margin : 72, top = narrow ? 64 : margin;
    const [width, height] = [Math.max(box[2] - box[0], 0.5), Math.max(box[3] - box[1], 0.5)];
    this.scale = Math.min((this.width - margin - right) / width, (this.height - top - margin) / height);
    this.centre = [(box[0] + box[2] + (right - margin) / this.scale) / 2, (box[1] + box[3] + (top - margin) / this.scale) / 2];
  }

  toScreen([x, y]) {
    return [this.width / 2 + (x - this.centre[0]) * this.scale, this.height / 2 - (y - this.centre[1]) * this.scale];
  }

  toWorld([x, y]) {
    return [this.centre[0] + (x - this.width / 2) / this.scale, this.centre[1] - (y - this.height / 2) / this.scale];
  }

  zoom(factor, at = [this.width / 2, this.height / 2]) {
    const before = this.toWorld(at);
    this.scale = Math.min(Math.max(this.scale * factor, 0.5), 20000);
    const after = this.toWorld(at);
    this.centre = [this.centre[0] + before[0] - after[0], this.centre[1] + before[1] - after[1]];
  }

  pan(dx, dy) {
    this.centre = [this.centre[0] - dx / this.scale, this.centre[1] + dy / this.scale];
  }

  // World coordinates from here on: metres, y up.
  metres() {
    const { context, ratio, scale } = this;
    const [x, y] = [this.width / 2 - this.centre[0] * scale, this.height / 2 + this.centre[1] * scale];
    context.setTransform(ratio * scale, 0, 0, -ratio * scale, ratio * x, ratio * y);
  }

  pixels() {
    this.context.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
  }

  px(pixels) {
    return pixels / this.scale;
  }

  // Draws all. `moment` is {recording, frame, time, layers, goal, walls, held, selected}.
  draw(moment) {
    this.fitCanvas();
    const { context, colours } = this;
    this.pixels();
    context.fillStyle = colours.page;
    context.fillRect(0, 0, this.width, this.height);
    const { recording, layers } = moment;
    if (!recording) return;
    this.metres();
    this.floor(recording.scene);
    this.things(recording, moment);
    if (layers.lidar) this.lidar(recording.scan(moment.selected ?? 0, moment.frame));
    this.items(recording.overlay.filter((item) => ["disc", "polygon"].includes(item.kind)), moment);
    this.walls(recording.scene, moment.walls);
    this.items(recording.overlay.filter((item) => ["line", "points"].includes(item.kind)), moment);
    this.eachRobot(moment, (robot) => {
      if (layers.odometry) this.path(recording.beliefs[robot], moment, colours.belief, [5, 4], 1.4, robot);
      if (layers.path) this.path(recording.paths[robot], moment, this.colour(robot), [], 2.2, robot);
    });
    if (layers.marks) this.marks(recording, moment);
    const robots = recording.scene.robots;
    robots.forEach((spec, robot) => {
      const { pose, belief } = recording.robot(moment.frame, moment.time, robot);
      if (layers.odometry && robots.length <= 8 && apart(pose, belief)) this.ghost(spec, belief, colours.belief);
      if (layers.distances && robots.length <= 8) this.distances(spec, pose, recording.distances(robot, moment.frame));
      this.robot(spec, moment.held?.robot === robot ? moment.held.pose : pose, this.colour(robot), moment.selected === robot);
    });
    this.items(recording.overlay.filter((item) => item.kind === "mark"), moment);
    if (layers.contacts) robots.forEach((_, robot) => this.contacts(recording.contacts(robot, moment.frame)));
    this.pixels();
    this.scaleBar();
  }

  colour(robot) {
    return this.colours.robots[robot % this.colours.robots.length];
  }

  eachRobot({ recording }, draw, most = Infinity) {
    recording.scene.robots.forEach((_, robot) => { if (robot < most) draw(robot); });
  }

  floor(scene) {
    const { context, colours } = this, [left, bottom, right, top] = scene.floor;
    context.fillStyle = scene.robots.some(({ drive }) => drive === "craft") ? colours.water : colours.floor;
    context.fillRect(left, bottom, right - left, top - bottom);
    if (scene.relief) this.relief(scene.relief);
    const step = [0.1, 0.5, 1, 5, 10, 50, 100].find((step) => step * this.scale >= 24);
    if (!step || (right - left) / step > 400) return;
    context.beginPath();
    for (let x = Math.ceil(left / step) * step; x <= right; x += step) { context.moveTo(x, bottom); context.lineTo(x, top); }
    for (let y = Math.ceil(bottom / step) * step; y <= top; y += step) { context.moveTo(left, y); context.lineTo(right, y); }
    context.strokeStyle = colours.grid;
    context.lineWidth = this.px(1);
    context.stroke();
  }

  // Hills in light from the upper left, lighter the higher. The picture is made once a scene.
  relief(relief) {
    const { context } = this, [left, bottom, right, top] = relief.area;
    this.hills = this.hills?.relief === relief ? this.hills : { relief, picture: shaded(relief) };
    context.save();
    // The rows of a picture go down.
    context.translate(left, top);
    context.scale(1, -1);
    context.drawImage(this.hills.picture, 0, 0, right - left, top - bottom);
    context.restore();
  }

  // Paths of walls by colour and thickness, made once a scene.
  walls(scene, drawn) {
    const { context, colours } = this;
    if (this.scenery?.scene !== scene) {
      const paths = new Map();
      for (const [x0, y0, x1, y1, thickness, colour] of scene.walls) {
        const key = `${thickness} ${colourful(colour) ? colour : ""}`;
        if (!paths.has(key)) paths.set(key, { path: new Path2D(), thickness, colour: colourful(colour) ? colour : null });
        const { path } = paths.get(key);
        path.moveTo(x0, y0);
        path.lineTo(x1, y1);
      }
      this.scenery = { scene, paths: [...paths.values()] };
    }
    context.lineCap = "square";
    for (const { path, thickness, colour } of this.scenery.paths) {
      context.strokeStyle = colour ?? colours.wall;
      context.lineWidth = Math.max(thickness, this.px(1.6));
      context.stroke(path);
    }
    context.lineCap = "round";
    context.strokeStyle = colours.accent;
    context.lineWidth = Math.max(0.01, this.px(3));
    for (const [x0, y0, x1, y1] of drawn) {
      context.beginPath();
      context.moveTo(x0, y0);
      context.lineTo(x1, y1);
      context.stroke();
    }
  }

  things({ scene }, moment) {
    const { context, colours } = this, moved = moment.recording.objects(moment.frame);
    for (const { at, colour } of scene.markers) {
      context.fillStyle = colour;
      context.globalAlpha = 0.35;
      this.disc(at, 0.05);
      context.globalAlpha = 1;
    }
    this.pixels();
    context.font = "600 13px system-ui, sans-serif";
    context.textAlign = "center";
    context.textBaseline = "middle";
    context.fillStyle = colours.soft;
    if (scene.places.length < 60) for (const { letter, at } of scene.places) context.fillText(letter, ...this.toScreen(at));
    this.metres();
    scene.objects.forEach((object, index) => {
      let { pose } = object;
      const found = moved.get(index), fallen = found?.fallen;
      if (found) pose = found.pose;
      if (moment.held?.object === index) pose = moment.held.pose;
      context.save();
      context.translate(pose[0], pose[1]);
      context.rotate(pose[2]);
      context.globalAlpha = fallen ? 0.3 : 1;
      context.fillStyle = object.colour;
      context.strokeStyle = `color-mix(in srgb, ${object.colour} 60%, ${colours.ink})`;
      context.lineWidth = this.px(1.2);
      context.beginPath();
      if (Array.isArray(object.size)) context.rect(-object.size[0] / 2, -object.size[1] / 2, object.size[0], object.size[1]);
      else context.arc(0, 0, Math.max(object.size, this.px(2.5)), 0, 2 * Math.PI);
      context.fill();
      context.stroke();
      context.restore();
    });
    context.strokeStyle = colours.soft;
    context.lineWidth = this.px(3);
    for (const { pose: [x, y, heading], width } of scene.boards) {
      const [dx, dy] = [-Math.sin(heading) * width / 2, Math.cos(heading) * width / 2];
      context.beginPath();
      context.moveTo(x - dx, y - dy);
      context.lineTo(x + dx, y + dy);
      context.stroke();
    }
  }

  disc([x, y], radius) {
    this.context.beginPath();
    this.context.arc(x, y, radius, 0, 2 * Math.PI);
    this.context.fill();
  }

  lidar(scan) {
    if (!scan) return;
    const { context, colours } = this, { x, y, first, step, ranges } = scan;
    const ends = [];
    context.beginPath();
    context.moveTo(x, y);
    for (let beam = 0; beam < ranges.length; beam++) {
      const angle = first + step * beam, range = ranges[beam];
      if (range === Infinity) { context.lineTo(x, y); continue; }
      const end = [x + range * Math.cos(angle), y + range * Math.sin(angle)];
      ends.push(end);
      context.lineTo(...end);
    }
    context.closePath();
    context.fillStyle = colours.lidar;
    context.globalAlpha = 0.07;
    context.fill();
    context.globalAlpha = 0.85;
    const size = this.px(2.6);
    for (const [ex, ey] of ends) context.fillRect(ex - size / 2, ey - size / 2, size, size);
    context.globalAlpha = 1;
  }

  distances(spec, [x, y, heading], distances) {
    if (!distances) return;
    const { context, colours } = this, cos = Math.cos(heading), sin = Math.sin(heading);
    context.strokeStyle = colours.psd;
    context.fillStyle = colours.psd;
    context.lineWidth = this.px(1.5);
    for (const { id, at: [px, py, yaw], range } of spec.psds) {
      if (!distances.has(id)) continue;
      const far = distances.get(id), length = Math.min(far, range);
      const from = [x + cos * px - sin * py, y + sin * px + cos * py];
      const to = [from[0] + length * Math.cos(heading + yaw), from[1] + length * Math.sin(heading + yaw)];
      context.globalAlpha = far === Infinity ? 0.2 : 0.75;
      context.beginPath();
      context.moveTo(...from);
      context.lineTo(...to);
      context.stroke();
      if (far !== Infinity) this.disc(to, this.px(3));
    }
    context.globalAlpha = 1;
  }

  path(points, { frame, recording }, colour, dash, width, robot) {
    const { context } = this, crowd = recording.scene.robots.length > 12;
    if (crowd && dash.length) return;
    const from = crowd ? Math.max(0, frame - 150) : 0, least = this.px(1) ** 2;
    context.beginPath();
    let [x, y] = [points[2 * from], points[2 * from + 1]];
    context.moveTo(x, y);
    for (let index = from + 1; index <= frame; index++) {
      const [nx, ny] = [points[2 * index], points[2 * index + 1]], away = (nx - x) ** 2 + (ny - y) ** 2;
      if (away < least && index < frame) continue;
      if (away > 0.25) context.moveTo(nx, ny);
      else context.lineTo(nx, ny);
      [x, y] = [nx, ny];
    }
    context.strokeStyle = colour;
    context.lineWidth = this.px(width);
    context.lineJoin = "round";
    context.lineCap = dash.length ? "butt" : "round";
    context.setLineDash(dash.map((length) => this.px(length)));
    context.globalAlpha = robot === 0 || !crowd ? 0.8 : 0.4;
    context.stroke();
    context.globalAlpha = 1;
    context.setLineDash([]);
  }

  // What the robot knew at the time.
  items(items, { time, layers }) {
    const { context } = this;
    for (const item of items) {
      if (!layers[item.layer] || item.from > time || (item.until !== null && item.until < time)) continue;
      const { points, more, kind } = item;
      context.strokeStyle = this.readable(item.colour);
      context.fillStyle = context.strokeStyle;
      context.lineWidth = this.px(item.width);
      context.globalAlpha = item.opacity;
      context.setLineDash(item.dashed ? [this.px(6), this.px(4)] : []);
      if (kind === "mark") this.mark(item);
      else if (kind === "points") this.dots(points, this.px(item.width));
      else {
        context.beginPath();
        if (kind === "disc") context.arc(points[0], points[1], more, 0, 2 * Math.PI);
        else this.line(points, kind === "line" && more?.length ? more.filter((reached) => reached <= time).length : Infinity);
        if (kind === "polygon") context.closePath();
        context.stroke();
        context.globalAlpha = item.opacity * item.fill;
        if (item.fill > 0) context.fill();
      }
    }
    context.globalAlpha = 1;
    context.setLineDash([]);
  }

  line(points, most) {
    const { context } = this;
    let begun = false;
    for (let at = 0; at < points.length && at < 2 * most; at += 2) {
      // A point that is none leaves a gap.
      if (points[at] === null || points[at + 1] === null) begun = false;
      else if (begun) context.lineTo(points[at], points[at + 1]);
      else { context.moveTo(points[at], points[at + 1]); begun = true; }
    }
  }

  dots(points, size) {
    const { context } = this;
    for (let at = 0; at < points.length; at += 2) {
      if (points[at] !== null) context.fillRect(points[at] - size / 2, points[at + 1] - size / 2, size, size);
    }
  }

  mark({ points, more: [mark, text] }) {
    const { context, colours } = this;
    this.pixels();
    const [x, y] = this.toScreen(points);
    context.lineWidth = 2;
    context.fillStyle = context.strokeStyle = { HitPoint: colours.bad, LeavePoint: colours.goal }[mark] ?? colours.soft;
    if (mark) {
      context.beginPath();
      if (mark === "HitPoint") context.rect(x - 4, y - 4, 8, 8);
      else if (mark === "LeavePoint") { context.moveTo(x, y - 6); context.lineTo(x + 6, y); context.lineTo(x, y + 6); context.lineTo(x - 6, y); }
      else context.arc(x, y, 4, 0, 2 * Math.PI);
      context.fill();
    }
    if (text) {
      context.font = "600 12px system-ui, sans-serif";
      context.textAlign = "left";
      context.textBaseline = "middle";
      context.lineWidth = 3;
      context.strokeStyle = colours.floor;
      context.strokeText(text, x + 8, y - 8);
      context.fillStyle = colours.ink;
      context.fillText(text, x + 8, y - 8);
    }
    this.metres();
  }

  // Black and dark grey are not seen in the dark.
  readable(colour) {
    return `color-mix(in srgb, ${colour} 82%, ${this.colours.ink})`;
  }

  marks({ scene }, { goal, held }) {
    const { context, colours } = this, at = held?.goal ?? goal;
    this.pixels();
    const [sx, sy] = this.toScreen(scene.robots[0].pose);
    context.strokeStyle = colours.soft;
    context.lineWidth = 1.5;
    context.beginPath();
    context.arc(sx, sy, 5, 0, 2 * Math.PI);
    context.stroke();
    if (at) {
      const [x, y] = this.toScreen(at);
      context.strokeStyle = colours.goal;
      context.fillStyle = colours.goal;
      context.lineWidth = 2;
      context.beginPath();
      context.arc(x, y, 4, 0, 2 * Math.PI);
      context.fill();
      context.beginPath();
      context.moveTo(x, y);
      context.lineTo(x, y - 24);
      context.stroke();
      context.beginPath();
      context.moveTo(x, y - 24);
      context.lineTo(x + 16, y - 19);
      context.lineTo(x, y - 13);
      context.fill();
    }
    this.metres();
  }

  contacts(places) {
    if (!places.length) return;
    const { context, colours } = this;
    this.pixels();
    context.strokeStyle = colours.bad;
    context.lineWidth = 2.2;
    context.lineCap = "round";
    for (const place of places) {
      const [x, y] = this.toScreen(place);
      context.beginPath();
      context.moveTo(x - 5, y - 5);
      context.lineTo(x + 5, y + 5);
      context.moveTo(x - 5, y + 5);
      context.lineTo(x + 5, y - 5);
      context.stroke();
    }
    this.metres();
  }

  outline(spec) {
    const { context } = this;
    context.beginPath();
    if (Array.isArray(spec.outline)) {
      const [left, bottom, right, top] = spec.outline, corner = 0.18 * Math.min(right - left, top - bottom);
      context.roundRect(left, bottom, right - left, top - bottom, corner);
    } else {
      context.arc(0, 0, spec.outline, 0, 2 * Math.PI);
    }
  }

  ghost(spec, [x, y, heading], colour) {
    const { context } = this;
    context.save();
    context.translate(x, y);
    context.rotate(heading);
    this.outline(spec);
    context.strokeStyle = colour;
    context.lineWidth = this.px(1.4);
    context.setLineDash([this.px(4), this.px(3)]);
    context.stroke();
    context.restore();
  }

  robot(spec, [x, y, heading], colour, selected) {
    // A car on a race track is still seen.
    const { context, colours } = this, larger = Math.max(1, this.px(8) / reach(spec)), radius = reach(spec);
    context.save();
    context.translate(x, y);
    context.rotate(heading);
    context.scale(larger, larger);
    context.fillStyle = `color-mix(in srgb, ${colours.ink} 82%, ${colours.panel})`;
    for (const [wx, wy] of wheels(spec)) {
      const width = 0.32 * spec.wheel;
      context.fillRect(wx - spec.wheel / 2, wy - width / 2, spec.wheel, width);
    }
    this.outline(spec);
    context.fillStyle = `color-mix(in srgb, ${colour} 78%, ${colours.floor})`;
    context.fill();
    context.strokeStyle = `color-mix(in srgb, ${colour} 75%, ${colours.ink})`;
    context.lineWidth = this.px(1.5);
    context.stroke();
    const front = Array.isArray(spec.outline) ? spec.outline[2] : spec.outline, size = 0.34 * Math.min(radius, front * 1.5);
    context.fillStyle = colours.floor;
    context.beginPath();
    context.moveTo(front * 0.86, 0);
    context.lineTo(front * 0.86 - size, 0.62 * size);
    context.lineTo(front * 0.86 - size, -0.62 * size);
    context.fill();
    if (selected) {
      context.strokeStyle = colours.accent;
      context.fillStyle = colours.accent;
      context.lineWidth = this.px(1.5);
      const far = radius + this.px(20);
      context.beginPath();
      context.arc(0, 0, radius + this.px(5), 0, 2 * Math.PI);
      context.moveTo(radius + this.px(5), 0);
      context.lineTo(far, 0);
      context.stroke();
      this.disc([far, 0], this.px(5));
    }
    context.restore();
  }

  scaleBar() {
    const { context, colours } = this;
    const length = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200].find((length) => length * this.scale > 60) ?? 500;
    const [x, y, width] = [14, this.height - 14, length * this.scale];
    context.strokeStyle = colours.soft;
    context.fillStyle = colours.soft;
    context.lineWidth = 1.5;
    context.beginPath();
    context.moveTo(x, y - 4);
    context.lineTo(x, y);
    context.lineTo(x + width, y);
    context.lineTo(x + width, y - 4);
    context.stroke();
    context.font = "12px system-ui, sans-serif";
    context.textAlign = "left";
    context.textBaseline = "alphabetic";
    context.fillText(length < 1 ? `${Math.round(length * 100)} cm` : `${length} m`, x + width + 7, y);
  }
}

// Metres from a robot's middle to the farthest point of its outline.
export function reach(spec) {
  if (!Array.isArray(spec.outline)) return spec.outline;
  const [left, bottom, right, top] = spec.outline;
  return Math.hypot(Math.max(-left, right), Math.max(-bottom, top));
}

function wheels(spec) {
  const half = spec.track / 2;
  if (spec.drive === "differential") return [[0, half], [0, -half]];
  if (spec.drive === "car") return [[0, half], [0, -half], [spec.wheelbase, half], [spec.wheelbase, -half]];
  const ahead = spec.wheelbase / 2;
  return spec.drive === "omni" ? [[ahead, half], [ahead, -half], [-ahead, half], [-ahead, -half]] : [];
}

function apart(a, b) {
  return Math.hypot(a[0] - b[0], a[1] - b[1]) > 0.01 || Math.abs(a[2] - b[2]) % (2 * Math.PI) > 0.05;
}

// Whether a colour is neither grey nor white nor black.
function colourful(colour) {
  const [red, green, blue] = [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16));
  return Math.max(red, green, blue) - Math.min(red, green, blue) > 24;
}
