// The page: what is shown, what is played, and what the buttons do.
import { MESSAGE, Runner } from "./runner.js";
import { Live } from "./live.js";
import { Recording } from "./recording.js";
import { View } from "./draw.js";
import { attach } from "./pointer.js";
import { Desk } from "./desk.js";
import { PROGRAM, optionsIn } from "./programs.js";
import { CHAPTERS, RANK, nameOf, optionFor } from "./systems.js";
import { fill, optionsOf, wordsOf } from "./options.js";
import { fromHash, toHash } from "./link.js";

const $ = (id) => document.getElementById(id);
const FRAME = 0.04;
const LAYERS = { path: "true path", odometry: "odometry", lidar: "lidar", distances: "distance sensors", marks: "start and goal", contacts: "contacts" };

const view = new View($("stage"));
const files = new Map();
const layers = Object.fromEntries(Object.keys(LAYERS).map((name) => [name, true]));
const run = { command: "distbug", values: {}, wishes: [], walls: [] };
let runner, live = null, commands = [], recording = null, time = 0, playing = true, ended = null, dirty = true, fitted = null;
let held = null, sketch = null, selected = null, follows = false, drawing = false, started = 0, first = null;

// ---- running

// Runs from the beginning, or, with what hands have done, from a moment on: what was before stays as it is.
function start(from = 0) {
  ended = null;
  started = performance.now();
  first = null;
  if (from === 0) {
    recording = null;
    time = 0;
    $("log").replaceChildren();
    $("story").hidden = true;
  } else {
    recording?.cut(from);
    for (const line of [...$("log").children]) if (Number(line.dataset.time) >= from) line.remove();
  }
  notice(null);
  $("drawing").hidden = true;
  $("picture").replaceChildren();
  history.replaceState(null, "", toHash(run));
  const words = wordsOf(commandOf(run.command), run.values), receive = (bytes, entries) => entries.forEach((entry) => hear(bytes, entry, from));
  const job = { words, wishes: run.wishes, walls: run.walls, from };
  showHands();
  if (run.command === PROGRAM.name) {
    runner.stop();
    $("command").textContent = desk.start(job, files, receive, over);
  } else {
    desk.stop();
    $("command").textContent = `roverlab ${words.join(" ")}`;
    runner.start(JSON.stringify(job), files, receive, over);
  }
  playing = true;
  update();
}

function hear(bytes, [message, at, length], from) {
  const text = () => new TextDecoder().decode(new Uint8Array(bytes, at, length));
  if (message === MESSAGE.frame) {
    recording.add(new DataView(bytes, at, length));
    first ??= performance.now();
    dirty = true;
  } else if (message === MESSAGE.scene) {
    scene(JSON.parse(text()), from);
  } else if (message === MESSAGE.told) {
    tell(new DataView(bytes, at, 8).getFloat64(0, true), new TextDecoder().decode(new Uint8Array(bytes, at + 8, length - 8)));
  } else if (message === MESSAGE.overlay) {
    overlay(JSON.parse(text()));
  } else if (message === MESSAGE.picture) {
    picture(text());
  } else if (message === MESSAGE.ended) {
    ended = { ...JSON.parse(text()), seconds: (performance.now() - started) / 1000 };
  } else if (message === MESSAGE.beside) {
    beside(JSON.parse(text()));
  } else if (message === MESSAGE.panicked) {
    ended = { status: 1, output: "", errors: text() };
  }
}

// A command may set up a scene or two before the one that it is about: the last one is shown.
function scene(found, from) {
  if (from > 0 && recording) {
    recording.scene.walls = found.walls;
    return;
  }
  recording = new Recording(found);
  const key = `${run.command} ${JSON.stringify(found.bounds)}`;
  if (fitted !== key) {
    fit();
    fitted = key;
  }
  selected = null;
  $("eyes").hidden = true;
  $("face").hidden = true;
}

// What runs beside the page. What happens now is shown, unless somebody looks back.
function beside({ command, recording: isRecording = false }) {
  const [name, ...words] = command.split(" ");
  run.command = name;
  run.values = Object.fromEntries(words.map((word) => word.replace(/^--/, "").split(/=(.*)/s)));
  document.title = `${command} – roverlab`;
  $("title").textContent = nameOf(run.command);
  $("about").textContent = isRecording ? "A recording" : "Runs beside this page";
  $("command").textContent = `roverlab ${command}`;
  if (!isRecording) $("speed").value = "Infinity";
}

function over(failed) {
  if (failed && !ended) ended = { status: 1, output: "", errors: failed };
  if (ended?.errors) notice(ended.errors);
  update();
}

// ---- what is said

function notice(text, calm = false) {
  $("notice").hidden = !text;
  $("notice").textContent = text ?? "";
  $("notice").classList.toggle("calm", calm);
}

function tell(when, text) {
  const line = document.createElement("li"), stamp = document.createElement("time"), words = document.createElement("span");
  // Some lines begin with a time of their own.
  const [, own, said] = /^(?:\s*([\d.]+) s:?\s+)?(.*)$/s.exec(text);
  if (own) when = Number(own);
  stamp.textContent = `${when.toFixed(1)} s`;
  words.textContent = said;
  line.dataset.time = when;
  line.append(stamp, words);
  line.addEventListener("click", () => seek(when));
  $("log").append(line);
  $("story").hidden = false;
}

// What the robot knew: one more layer for each name that the legend of its picture has.
function overlay(items) {
  if (!recording) return;
  for (const item of items) item.layer = item.label ?? (item.kind === "mark" ? "marks of its way" : "other lines");
  recording.overlay = items;
  for (const name of new Set(items.map((item) => item.layer))) layers[name] ??= true;
  showLayers();
  dirty = true;
}

function showLayers() {
  const own = new Map((recording?.overlay ?? []).map((item) => [item.layer, item.colour]));
  const rows = [...Object.entries(LAYERS), ...[...own.keys()].map((name) => [name, name])].map(([name, text]) => {
    const label = document.createElement("label"), box = document.createElement("input");
    [box.type, box.checked] = ["checkbox", layers[name]];
    box.addEventListener("change", () => { layers[name] = box.checked; dirty = true; });
    label.append(box, text);
    if (own.has(name)) label.style.setProperty("--swatch", own.get(name));
    return label;
  });
  const legend = document.createElement("legend");
  legend.textContent = "Shown";
  $("layer-box").replaceChildren(legend, ...rows);
}

function picture(svg) {
  const image = new Image();
  image.src = URL.createObjectURL(new Blob([svg], { type: "image/svg+xml" }));
  image.alt = "The whole run from above";
  $("picture").replaceChildren(image);
  $("picture").href = image.src;
  $("picture").download = `${run.command}.svg`;
}

// The report's first line is the verdict, the others are names and values.
function report() {
  if (!ended) return;
  $("drawing").hidden = $("picture").children.length === 0;
  const [head, ...rest] = ended.output.trim().split("\n");
  const word = head?.includes(": ") ? head.split(": ").slice(1).join(": ").replaceAll("_", " ") : head;
  $("status").textContent = ended.output ? sentence(word) : "It cannot run like this";
  $("status").className = ended.status === 0 ? "good" : "bad";
  const shown = rest.map((line) => /^ {2}(.{18}) (.*)$/.exec(line)).filter((found) => found && !/picture|seed|noise|time limit/.test(found[1]) && found[2].length < 70);
  $("figures").replaceChildren(...shown.flatMap(([, name, value]) => {
    const [term, text] = [document.createElement("dt"), document.createElement("dd")];
    [term.textContent, text.textContent] = [name.trim(), value];
    return [term, text];
  }));
}

function sentence(word) {
  return word ? word[0].toUpperCase() + word.slice(1) : "";
}

function progress() {
  $("status").className = "";
  $("status").textContent = recording?.frames.length ? (playing ? "Driving" : "Paused") : "Starting";
  const frame = recording?.frames.length ? recording.index(time) : -1;
  if (frame < 0) return $("figures").replaceChildren();
  const { pose, contacts } = recording.robotAt(frame, 0);
  const degrees = Math.round((pose[2] * 180) / Math.PI) % 360;
  const rows = [["time", `${time.toFixed(1)} s`], ["place", `${mm(pose[0])}, ${mm(pose[1])} mm`], ["heading", `${degrees + 0}°`], ["contacts", String(contacts)]];
  $("figures").replaceChildren(...rows.flatMap(([name, value]) => {
    const [term, text] = [document.createElement("dt"), document.createElement("dd")];
    [term.textContent, text.textContent] = [name, value];
    return [term, text];
  }));
}

function mm(metres) {
  return Math.round(metres * 1000);
}

function showHands() {
  const parts = [];
  if (run.wishes.length) parts.push(`${run.wishes.length} ${run.wishes.length === 1 ? "thing" : "things"} done by hand`);
  if (run.walls.length) parts.push(`${run.walls.length} ${run.walls.length === 1 ? "wall" : "walls"} drawn`);
  $("hands").textContent = parts.join(", ");
  $("files").textContent = files.size ? `Opened: ${[...files.keys()].join(", ")}` : "";
}

// ---- time

function finished() {
  return ended !== null && recording && time >= recording.end;
}

function seek(when) {
  time = Math.min(Math.max(when, 0), recording?.end ?? 0);
  dirty = true;
  update();
}

function play(on) {
  if (on && finished()) time = 0;
  playing = on;
  dirty = true;
  update();
}

let before = performance.now();
function tick(now) {
  const passed = Math.min((now - before) / 1000, 0.25);
  before = now;
  if (playing && recording?.frames.length) {
    const speed = Number($("speed").value), last = time;
    time = speed === Infinity ? recording.end : Math.min(time + passed * speed, recording.end);
    if (time !== last) dirty = true;
    if (finished()) {
      playing = false;
      dirty = true;
    }
  }
  if (dirty) {
    dirty = false;
    draw();
  }
  requestAnimationFrame(tick);
}

function moment() {
  if (!recording?.frames.length) return { recording: null };
  const frame = recording.index(time), walls = sketch ? [...run.walls, sketch] : run.walls;
  return { recording, frame, time, layers, goal: goal(), walls, held, selected };
}

function draw() {
  const now = moment();
  if (follows && now.recording) view.centre = recording.robot(now.frame, time, selected ?? 0).pose.slice(0, 2);
  view.draw(now);
  page.drawn += 1;
  update();
  if (now.recording) devices(now.frame);
}

let updated = 0;
function update() {
  document.body.classList.toggle("playing", playing);
  $("play").setAttribute("aria-label", playing ? "Pause" : "Play");
  const end = recording?.end ?? 0;
  $("clock").textContent = `${time.toFixed(1)} s`;
  $("end").textContent = ended ? `${end.toFixed(1)} s` : `${end.toFixed(0)} s…`;
  $("slider").max = Math.max(end, FRAME);
  $("slider").value = time;
  $("slider").setAttribute("aria-valuetext", `${time.toFixed(1)} of ${end.toFixed(1)} seconds`);
  const now = performance.now();
  if (now - updated < 100 && playing) return;
  updated = now;
  // What comes after the moment that is shown is not given away.
  for (const line of $("log").children) line.classList.toggle("ahead", Number(line.dataset.time) > time + FRAME);
  if (ended && (!recording || time >= recording.end - FRAME)) report();
  else progress();
}

// ---- camera, display, keys

const shown = { image: null, display: null };
function devices(frame) {
  const robot = selected ?? 0;
  for (const [name, box, canvas] of [["image", "eyes", "camera"], ["display", "face", "display"]]) {
    const news = recording.last(name, robot, frame);
    if (news) $(box).hidden = false;
    if (!news || shown[name] === news) continue;
    shown[name] = news;
    createImageBitmap(new Blob([recording.bytes(news)], { type: "image/png" })).then((bitmap) => {
      if (shown[name] !== news) return;
      $(canvas).width = bitmap.width;
      $(canvas).height = bitmap.height;
      $(canvas).getContext("2d").drawImage(bitmap, 0, 0);
    }, () => {});
  }
  const menu = recording.menu(robot, frame);
  [...$("keys").children].forEach((button, index) => {
    const label = menu[index] || String(index + 1);
    if (button.textContent !== label) {
      button.textContent = label;
      button.setAttribute("aria-label", `Key ${index + 1}${menu[index] ? `: ${menu[index]}` : ""}`);
    }
  });
}

function pressKey(key) {
  if (live) return live.press(selected ?? 0, key);
  if (run.command === PROGRAM.name) return keyInProgram(key);
  byHand({ time: round(time), key, of: selected ?? 0 });
}

// What has pressed the keys of a program by itself so far does so no more, so that the run begins again.
function keyInProgram(key) {
  const from = desk.press(key, round(time)) && time > FRAME ? time : 0;
  showOptions();
  start(from);
  if (from) time = from;
}

// ---- hands

function round(number) {
  return Math.round(number * 1e4) / 1e4;
}

// What was done after this moment is forgotten: another run goes on from here.
function byHand(wish) {
  run.wishes = [...run.wishes.filter((other) => other.time < time || other.time === wish.time), wish];
  const from = time;
  start(from > FRAME ? from : 0);
  if (from > FRAME) time = from;
}

function goal() {
  const given = run.values.goal?.split(",").map((number) => Number(number) / 1000);
  if (given?.length >= 2 && given.every(Number.isFinite)) return given.slice(0, 2);
  const { markers, places, robots } = recording.scene, from = robots[0]?.pose;
  const away = ({ at }) => from && Math.hypot(at[0] - from[0], at[1] - from[1]) > 0.05;
  return markers.find(away)?.at ?? places.find(({ letter }) => letter.toLowerCase() === "g")?.at ?? null;
}

function takes(option) {
  return commandOf(run.command).options.some(({ name }) => name === option);
}

function set(values) {
  for (const [name, value] of Object.entries(values)) {
    if (value === undefined) delete run.values[name];
    else run.values[name] = value;
  }
  showOptions();
}

const desk = new Desk({ run, area: $("code"), menu: $("which"), begin: () => ACTIONS.go(), again: openProgram });

attach($("stage"), {
  view, moment, drawing: () => drawing, mayMove: () => live === null, redraw: () => { dirty = true; },
  loosen: () => { if (follows) toggle("follow"); },
  mayMoveGoal: () => takes("goal") && run.command !== "coverage",
  select: (robot) => { selected = robot; dirty = true; },
  hold: (what) => { held = what; },
  sketch: (ends) => { sketch = ends; },
  wall: (ends) => { run.walls = [...run.walls, ends.map(round)]; start(); },
  put: ({ robot, object, pose, goal: place }) => {
    if (place) {
      set({ goal: `${mm(place[0])},${mm(place[1])}` });
      start();
    } else if (robot === 0 && time < FRAME && !run.wishes.length) {
      set({ start: `${mm(pose[0])},${mm(pose[1])},${Math.round((pose[2] * 180) / Math.PI)}` });
      start();
    } else {
      byHand({ time: round(time), ...(robot === undefined ? { object } : { robot }), pose: pose.map(round) });
    }
  },
});

// ---- systems, options, files

function commandOf(name) {
  return commands.find((command) => command.name === name) ?? commands.find((command) => command.name === "distbug");
}

function showSystems() {
  const parts = CHAPTERS.flatMap(([chapter, names]) => {
    const head = document.createElement("h2");
    head.textContent = chapter;
    const links = names.filter((name) => commands.some((command) => command.name === name)).map((name) => {
      const link = document.createElement("a");
      [link.href, link.textContent, link.title] = [`#${name}`, nameOf(name), commandOf(name).about];
      link.dataset.command = name;
      return link;
    });
    return [head, ...links];
  });
  $("systems").replaceChildren(...parts);
}

function showOptions() {
  const command = commandOf(run.command);
  const known = run.command === PROGRAM.name ? new Map([...desk.worlds, ...files]) : files;
  fill($("options"), command, run.values, known, (name, value, given = value !== undefined) => {
    // The form stays as it is: it has the focus.
    if (given) run.values[name] = value;
    else delete run.values[name];
    start();
  });
}

function open(found) {
  Object.assign(run, found, { command: commandOf(found.command).name });
  const command = commandOf(run.command);
  $("title").textContent = nameOf(run.command);
  $("about").textContent = command.about;
  document.title = `${nameOf(run.command)} – roverlab`;
  for (const link of $("systems").querySelectorAll("a")) {
    const current = link.dataset.command === run.command;
    link.setAttribute("aria-current", String(current));
    if (current) link.scrollIntoView({ block: "nearest" });
  }
  closeMenu();
  $("program").hidden = run.command !== PROGRAM.name;
  if (run.command === PROGRAM.name) return openProgram();
  showOptions();
  start();
}

async function openProgram() {
  runner.stop();
  ended = null;
  if (!desk.isLoaded) notice("Python is being loaded", true);
  try {
    await desk.open();
  } catch (error) {
    return notice(error.message);
  }
  if (run.command !== PROGRAM.name) return;
  showOptions();
  start();
}

function halt() {
  if (!desk.busy) return;
  desk.stop();
  ended = { status: 1, output: `${run.values.program}: stopped`, errors: "", seconds: (performance.now() - started) / 1000 };
  // Shown at once, however short ago something else was.
  updated = 0;
  update();
}

async function take(list) {
  if (live) return;
  const source = list.find((file) => file.name.endsWith(".py"));
  if (source && commandOf(PROGRAM.name) === PROGRAM) {
    const text = await source.text();
    return open({ command: PROGRAM.name, values: { program: source.name, text, ...optionsIn(text) }, wishes: [], walls: [] });
  }
  const added = [];
  for (const file of list) {
    files.set(file.name, await file.arrayBuffer());
    added.push(file.name);
  }
  const options = optionsOf(commandOf(run.command)), end = (name) => name.toLowerCase().split(".").pop();
  const ranked = added.sort((a, b) => ((RANK.indexOf(end(a)) + 99) % 99) - ((RANK.indexOf(end(b)) + 99) % 99));
  const taken = new Set();
  for (const name of ranked) {
    const option = optionFor(name, options);
    if (option && !taken.has(option)) {
      taken.add(option);
      run.values[option] = name;
    }
  }
  showOptions();
  if (taken.size) {
    run.wishes = [];
    delete run.values.start;
    delete run.values.goal;
    showOptions();
    start();
  } else if (added.length) {
    notice(`${added.join(", ")}: opened for the world that names it`, true);
    showHands();
  }
}

// ---- buttons and keys

function fit() {
  if (recording) view.show(recording.scene.bounds);
  dirty = true;
}

function toggle(id) {
  const on = $(id).getAttribute("aria-pressed") !== "true";
  $(id).setAttribute("aria-pressed", String(on));
  if (id === "follow") follows = on;
  if (id === "draw") drawing = on && live === null;
  dirty = true;
}

function closeMenu() {
  $("systems").classList.remove("open");
  $("menu").setAttribute("aria-expanded", "false");
}

function theme() {
  const root = document.documentElement, dark = getComputedStyle(root).colorScheme === "dark";
  root.dataset.theme = dark ? "light" : "dark";
  view.readColours();
  dirty = true;
}

async function share() {
  const address = location.href;
  try {
    await navigator.clipboard.writeText(address);
    notice(files.size ? "The link is copied. It does not hold the files that you opened." : "The link is copied.", true);
  } catch {
    notice(address, true);
  }
}

const ACTIONS = {
  play: () => play(!playing),
  restart: () => seek(0),
  step: () => { play(false); seek(time + FRAME); },
  "zoom-in": () => { view.zoom(1.3); dirty = true; },
  "zoom-out": () => { view.zoom(1 / 1.3); dirty = true; },
  fit, theme, share, halt,
  go: () => { desk.take(); start(); },
  follow: () => toggle("follow"),
  draw: () => toggle("draw"),
  open: () => $("file").click(),
  reset: () => {
    if (run.command === PROGRAM.name) return desk.reset();
    Object.assign(run, { values: {}, wishes: [], walls: [] });
    showOptions();
    start();
  },
  layers: () => {
    $("layer-box").hidden = !$("layer-box").hidden;
    $("layers").setAttribute("aria-expanded", String(!$("layer-box").hidden));
  },
  menu: () => {
    const now = $("systems").classList.toggle("open");
    $("menu").setAttribute("aria-expanded", String(now));
  },
};

const SHORT = {
  " ": ACTIONS.play, k: ACTIONS.play, Home: ACTIONS.restart, End: () => seek(recording?.end ?? 0), "+": ACTIONS["zoom-in"], "=": ACTIONS["zoom-in"],
  "-": ACTIONS["zoom-out"], f: fit, r: ACTIONS.follow, w: ACTIONS.draw, ArrowRight: ACTIONS.step,
  ArrowLeft: () => { play(false); seek(time - FRAME); },
  1: () => pressKey(1), 2: () => pressKey(2), 3: () => pressKey(3), 4: () => pressKey(4),
  Escape: () => { if (drawing) toggle("draw"); closeMenu(); notice(null); selected = null; dirty = true; },
};

function listen() {
  for (const [id, act] of Object.entries(ACTIONS)) $(id).addEventListener("click", act);
  $("slider").addEventListener("input", () => { playing = false; seek(Number($("slider").value)); });
  $("file").addEventListener("change", () => { take([...$("file").files]); $("file").value = ""; });
  $("options").addEventListener("submit", (event) => event.preventDefault());
  addEventListener("hashchange", () => { if (!live) open(fromHash(location.hash)); });
  addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const { target } = event, typed = target.closest?.("input, select, textarea, .CodeMirror");
    if (event.key !== "Escape" && (typed || (target.closest?.("button, a, summary") && [" ", "Enter"].includes(event.key)))) return;
    const act = SHORT[event.key];
    if (!act) return;
    event.preventDefault();
    act();
  });
  addEventListener("dragover", (event) => { event.preventDefault(); $("drop").hidden = live !== null; });
  addEventListener("dragleave", (event) => { if (!event.relatedTarget) $("drop").hidden = true; });
  addEventListener("drop", (event) => { event.preventDefault(); $("drop").hidden = true; take([...event.dataTransfer.files]); });
  new ResizeObserver(() => { dirty = true; }).observe($("stage"));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { view.readColours(); dirty = true; });
  for (let key = 1; key <= 4; key++) {
    const button = document.createElement("button");
    button.addEventListener("click", () => pressKey(key));
    $("keys").append(button);
  }
  showLayers();
}

// What tests look at, and nothing else here uses.
const page = {
  drawn: 0,
  get state() {
    return {
      command: run.command, values: run.values, wishes: run.wishes, walls: run.walls, time, playing, end: recording?.end ?? 0,
      frames: recording?.frames.length ?? 0, ended, first: first === null ? null : first - started, selected, busy: (runner?.busy ?? true) || desk.busy,
    };
  },
  get view() { return view; },
  get recording() { return recording; },
  seek,
  pause: () => play(false),
  drawAt: (when) => { time = when; draw(); },
};
window.roverlab = page;

async function main() {
  view.readColours();
  listen();
  requestAnimationFrame(tick);
  if (Live.isHere()) {
    document.body.classList.add("beside");
    live = new Live((bytes, entry) => hear(bytes, entry, 0), over);
    return;
  }
  try {
    runner = await Runner.load();
  } catch (error) {
    $("status").textContent = "The page cannot run here";
    notice(`The simulator could not be started: ${error.message ?? error}`);
    return;
  }
  runner.start(null, files, (bytes, entries) => {
    for (const [message, at, length] of entries) {
      if (message === MESSAGE.options) commands = JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, at, length)));
    }
  }, (failed) => {
    if (failed) return notice(failed);
    if (document.body.dataset.programs !== undefined) commands.push(PROGRAM);
    showSystems();
    open(fromHash(location.hash || "#distbug"));
  });
}

main();
