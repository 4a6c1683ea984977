// What is known of a run: its scene, frames by time, and what came between them. The bytes of a frame are described in
// `view/src/frame.rs`.

const ROBOT = 28;
const OBJECT = 16;
const HEAD = 16;
const NEWS = { distances: 1, scan: 2, image: 3, display: 4, menu: 5, contacts: 6 };

export class Recording {
  constructor(scene) {
    this.scene = scene;
    this.times = [];
    this.frames = [];
    this.overlay = [];
    const list = () => scene.robots.map(() => []);
    this.paths = list();
    this.beliefs = list();
    // Of each robot the frames with news of a kind: {frame, start, length}.
    this.news = Object.fromEntries(Object.keys(NEWS).map((name) => [name, list()]));
  }

  get end() {
    return this.times.length ? this.times[this.times.length - 1] : 0;
  }

  add(view) {
    const index = this.frames.length;
    this.times.push(view.getFloat64(0, true));
    const robots = view.getUint16(8, true), moved = view.getUint16(10, true), count = view.getUint16(12, true);
    this.frames.push(view);
    for (let robot = 0; robot < robots; robot++) {
      const at = HEAD + ROBOT * robot;
      this.paths[robot].push(view.getFloat32(at, true), view.getFloat32(at + 4, true));
      this.beliefs[robot].push(view.getFloat32(at + 12, true), view.getFloat32(at + 16, true));
    }
    let at = HEAD + ROBOT * robots + OBJECT * moved;
    for (let n = 0; n < count; n++) {
      const kind = view.getUint16(at, true), robot = view.getUint16(at + 2, true), length = view.getUint32(at + 4, true);
      const name = Object.keys(NEWS)[kind - 1];
      this.news[name][robot].push({ frame: index, start: at + 8, length });
      at += 8 + length;
    }
  }

  // Forgets all from a time on.
  cut(time) {
    const keep = this.index(time - 1e-9) + 1;
    if (keep >= this.frames.length && this.end < time) return;
    const left = this.times[0] >= time ? 0 : keep;
    this.times.length = left;
    this.frames.length = left;
    for (const path of [...this.paths, ...this.beliefs]) path.length = 2 * left;
    for (const robots of Object.values(this.news)) {
      for (const list of robots) while (list.length && list[list.length - 1].frame >= left) list.pop();
    }
  }

  // The last frame that is not after a time.
  index(time) {
    let low = 0, high = this.times.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (this.times[middle] <= time) low = middle;
      else high = middle - 1;
    }
    return low;
  }

  robotAt(frame, robot) {
    const view = this.frames[frame], at = HEAD + ROBOT * robot;
    const number = (offset) => view.getFloat32(at + offset, true);
    return {
      pose: [number(0), number(4), number(8)],
      belief: [number(12), number(16), number(20)],
      contacts: view.getUint32(at + 24, true),
    };
  }

  // A robot between two frames.
  robot(frame, time, robot) {
    const here = this.robotAt(frame, robot);
    if (frame + 1 >= this.frames.length || time <= this.times[frame]) return here;
    const next = this.robotAt(frame + 1, robot);
    const share = (time - this.times[frame]) / (this.times[frame + 1] - this.times[frame]);
    here.pose = between(here.pose, next.pose, share);
    here.belief = between(here.belief, next.belief, share);
    return here;
  }

  // The objects that are not where the scene has them.
  objects(frame) {
    const view = this.frames[frame], found = new Map();
    let at = HEAD + ROBOT * view.getUint16(8, true);
    for (let n = view.getUint16(10, true); n > 0; n--, at += OBJECT) {
      const pose = [4, 8, 12].map((offset) => view.getFloat32(at + offset, true));
      found.set(view.getUint16(at, true), { pose, fallen: view.getUint16(at + 2, true) !== 0 });
    }
    return found;
  }

  // The last news of a kind up to a frame, if there are any that are not older than so many frames.
  last(name, robot, frame, age = Infinity) {
    const list = this.news[name][robot];
    let low = 0, high = list.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (list[middle].frame <= frame) low = middle + 1;
      else high = middle;
    }
    const found = list[low - 1];
    return found && frame - found.frame <= age ? found : null;
  }

  distances(robot, frame) {
    const news = this.last("distances", robot, frame, 25);
    if (!news) return null;
    const view = this.frames[news.frame], found = new Map();
    for (let at = news.start; at < news.start + news.length; at += 8) {
      found.set(view.getUint32(at, true), view.getFloat32(at + 4, true));
    }
    return found;
  }

  // A scan: the scanner's pose in the world when it was made, and metres by beam.
  scan(robot, frame) {
    const news = this.last("scan", robot, frame, 40);
    if (!news) return null;
    const view = this.frames[news.frame];
    const [first, step, x, y, heading] = [0, 4, 8, 12, 16].map((offset) => view.getFloat32(news.start + offset, true));
    const ranges = new Float32Array((news.length - 20) / 2);
    for (let beam = 0; beam < ranges.length; beam++) {
      const range = view.getUint16(news.start + 20 + 2 * beam, true);
      ranges[beam] = range === 65535 ? Infinity : range / 1000;
    }
    const [rx, ry, turn] = this.robotAt(news.frame, robot).pose, cos = Math.cos(turn), sin = Math.sin(turn);
    return { x: rx + cos * x - sin * y, y: ry + sin * x + cos * y, first: turn + heading + first, step, ranges };
  }

  bytes(news) {
    const view = this.frames[news.frame];
    return new Uint8Array(view.buffer, view.byteOffset + news.start, news.length);
  }

  menu(robot, frame) {
    const news = this.last("menu", robot, frame);
    return news ? new TextDecoder().decode(this.bytes(news)).split("\n") : ["", "", "", ""];
  }

  contacts(robot, frame) {
    const found = [];
    for (const news of this.news.contacts[robot]) {
      if (news.frame > frame) break;
      const view = this.frames[news.frame];
      for (let at = news.start; at < news.start + news.length; at += 8) {
        found.push([view.getFloat32(at, true), view.getFloat32(at + 4, true)]);
      }
    }
    return found;
  }
}

// Farther than that in a frame, it was carried.
const JUMP = 0.5;

function between(a, b, share) {
  if (Math.hypot(b[0] - a[0], b[1] - a[1]) > JUMP) return a;
  const turn = Math.atan2(Math.sin(b[2] - a[2]), Math.cos(b[2] - a[2]));
  return [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]), a[2] + share * turn];
}
