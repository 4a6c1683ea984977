// Fingers and mice on the stage: panning, zooming, carrying robots, objects and the goal, drawing walls.
import { reach } from "./draw.js";

const NEAR = 14;

// `host` says what there is and does what comes of it: {view, moment(), drawing(), redraw(), select(robot), put(held), wall(ends)}.
export function attach(canvas, host) {
  const { view } = host, pointers = new Map();
  let action = null, spread = 0;
  const place = (event) => {
    const box = canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };

  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, place(event));
    if (pointers.size === 2) {
      [action, spread] = [{ kind: "pinch" }, distance(pointers)];
      return;
    }
    const at = place(event), world = view.toWorld(at);
    if (host.drawing()) action = { kind: "wall", ends: [...world, ...world] };
    else action = (host.mayMove() ? grip(host, at, world) : null) ?? { kind: "pan", moved: false };
    canvas.style.cursor = "grabbing";
  });

  canvas.addEventListener("pointermove", (event) => {
    const at = place(event), before = pointers.get(event.pointerId), world = view.toWorld(at);
    if (!before) {
      canvas.style.cursor = host.drawing() ? "crosshair" : grip(host, at, world) ? "move" : "grab";
      return;
    }
    pointers.set(event.pointerId, at);
    if (!action) return;
    const [dx, dy] = [at[0] - before[0], at[1] - before[1]];
    if (action.kind === "pinch" && pointers.size === 2) {
      const now = distance(pointers), [a, b] = [...pointers.values()];
      view.zoom(now / spread, [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2]);
      view.pan(dx / 2, dy / 2);
      spread = now;
      host.loosen();
    } else if (action.kind === "pan") {
      action.moved ||= Math.hypot(dx, dy) > 1;
      view.pan(dx, dy);
      host.loosen();
    } else if (action.kind === "wall") {
      [action.ends[2], action.ends[3]] = world;
      host.sketch(action.ends);
    } else {
      action.moved = true;
      action.carry(world);
      host.hold(action.held);
    }
    host.redraw();
  });

  const release = (event) => {
    pointers.delete(event.pointerId);
    const done = action;
    if (pointers.size > 0) return;
    action = null;
    canvas.style.cursor = "grab";
    if (!done) return;
    if (done.kind === "wall") {
      host.sketch(null);
      const [x0, y0, x1, y1] = done.ends;
      if (event.type === "pointerup" && Math.hypot(x1 - x0, y1 - y0) > 0.02) host.wall(done.ends);
    } else if (done.kind === "carry") {
      host.select(done.held.robot ?? null);
      host.hold(null);
      if (done.moved && event.type === "pointerup") host.put(done.held);
    } else if (done.kind === "pan" && !done.moved) {
      host.select(null);
    }
    host.redraw();
  };
  canvas.addEventListener("pointerup", release);
  canvas.addEventListener("pointercancel", release);

  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    view.zoom(Math.exp(-event.deltaY * (event.deltaMode === 1 ? 0.05 : 0.0015)), place(event));
    host.redraw();
  }, { passive: false });
}

function distance(pointers) {
  const [a, b] = [...pointers.values()];
  return Math.max(1, Math.hypot(a[0] - b[0], a[1] - b[1]));
}

// What a finger has hold of.
function grip(host, at, world) {
  const moment = host.moment(), { view } = host;
  if (!moment.recording) return null;
  const { recording, frame, time, goal } = moment;
  const near = (place, radius) => {
    const [x, y] = view.toScreen(place);
    return Math.hypot(x - at[0], y - at[1]) <= Math.max(NEAR, radius * view.scale);
  };
  const carry = (held, move) => ({ kind: "carry", moved: false, held, carry: move });
  const robots = recording.scene.robots.map((spec, robot) => ({ spec, robot, pose: recording.robot(frame, time, robot).pose }));
  const chosen = robots[moment.selected];
  if (chosen) {
    const far = reach(chosen.spec) + view.px(20), [x, y, heading] = chosen.pose;
    if (near([x + far * Math.cos(heading), y + far * Math.sin(heading)], 0)) {
      const held = { robot: chosen.robot, pose: [...chosen.pose] };
      return carry(held, ([wx, wy]) => { held.pose[2] = Math.atan2(wy - y, wx - x); });
    }
  }
  const robot = robots.find(({ pose, spec }) => near(pose, reach(spec)));
  if (robot) {
    const held = { robot: robot.robot, pose: [...robot.pose] }, off = [robot.pose[0] - world[0], robot.pose[1] - world[1]];
    return carry(held, ([x, y]) => { [held.pose[0], held.pose[1]] = [x + off[0], y + off[1]]; });
  }
  if (goal && host.mayMoveGoal() && near(goal, 0)) {
    const held = { goal: [...goal] };
    return carry(held, (place) => { held.goal = place; });
  }
  const moved = recording.objects(frame);
  const object = recording.scene.objects.findIndex((object, index) => {
    const size = Array.isArray(object.size) ? Math.min(...object.size) / 2 : object.size;
    return near(moved.get(index)?.pose ?? object.pose, size);
  });
  if (object < 0) return null;
  const pose = [...(moved.get(object)?.pose ?? recording.scene.objects[object].pose)], held = { object, pose };
  const off = [pose[0] - world[0], pose[1] - world[1]];
  return carry(held, ([x, y]) => { [held.pose[0], held.pose[1]] = [x + off[0], y + off[1]]; });
}
