// The systems of the page: what they are called here, and the options that a page has another way of giving, or none.

export const CHAPTERS = [
  ["Driving", ["first-steps", "ping", "a-to-b", "random-drive", "coverage"]],
  ["Lidar", ["lidar-scan", "localise"]],
  ["Swarms", ["follow-me"]],
  ["Walls", ["wall-following"]],
  ["Other drives", ["ackermann", "omni"]],
  ["Hills", ["summit", "ramp"]],
  ["Water", ["pool-wall", "dive", "survey", "pool-search", "boat"]],
  ["Mazes", ["maze-left", "maze-lidar", "maze-explore", "micromouse"]],
  ["Navigation", ["distbug", "bug-compare", "navigate"]],
  ["Robot vision", ["camera", "edges", "color-tracking", "motion"]],
  ["Evolution", ["genetic"]],
  ["Driverless cars", ["lane-keeping", "traffic", "parking", "base-station", "end-to-end"]],
  ["Formula SAE", ["cone-race", "cone-drive", "safety"]],
  ["Programs", ["program"]],
];

const NAMES = {
  "a-to-b": "From A to B", "color-tracking": "Colour tracking", ackermann: "A car", omni: "Mecanum wheels", distbug: "DistBug",
  "bug-compare": "Eleven bugs", motion: "Motion detection", genetic: "Evolved wall follower", "cone-race": "Cone race",
  "end-to-end": "By a network", summit: "To the summit", ramp: "A ramp over the lane", "pool-wall": "Along a pool's sides", survey: "A map of a pool",
  boat: "A raft on its course", "maze-left": "Left hand", "maze-lidar": "Left wall by lidar", "maze-explore": "Exploring a maze",
  safety: "Safety system", "lidar-scan": "Lidar scan", "first-steps": "To a wall and back", ping: "Ping by radio",
  "follow-me": "Follow me", edges: "Edges in images", program: "Programs in Python", dive: "To a depth",
  traffic: "Obstacles and halts", parking: "Parking a car",
  "base-station": "Cars under a base station",
};

export function nameOf(command) {
  return NAMES[command] ?? (command[0].toUpperCase() + command.slice(1)).replaceAll("-", " ");
}

// Options that every system has, in the order in which the page shows them.
export const FIRST = ["seed", "noise", "time-limit"];
// What drags and files say, and what goes beneath.
export const LAST = ["start", "goal", "world", "robot", "track", "maze", "line", "input", "quantised", "fault", "supervised"];
export const FILES = ["world", "robot", "track", "maze", "line", "input"];
const HIDDEN = new Set([
  "record", "force", "fsync", "replay", "picture", "robios", "json", "timing", "realtime", "threads", "processes", "checkpoint", "campaign", "worlds",
  "levels", "save", "runs", "animation", "output", "lcd", "plan", "compare", "steps", "mms", "mms-run", "mms-limit", "rooms",
  "map", "starts", "scenes", "pairs", "courses", "second", "families", "explore", "repeat", "part", "out",
]);

export function isShown(option) {
  return !HIDDEN.has(option.name);
}

// What the page's runs differ in from those of the command.
export const OVERRIDES = {
  "bug-compare": {
    always: { runs: "1" },
    options: {
      bugs: {
        kind: "choice", default: "Bug1", always: true, help: "Which algorithm drives",
        choices: ["Bug1", "Bug2", "Alg1", "Alg2", "DistBug", "TangentBug", "OneBug", "LeaveBug", "Rev1", "Rev2", "Class1"],
      },
    },
  },
  genetic: { options: { task: { default: "wall", always: true }, generations: { default: "5", always: true } } },
  camera: { options: { images: { default: "40", always: true } } },
  traffic: { options: { laps: { default: "1", always: true } } },
  "end-to-end": { options: { minutes: { default: "0.5", always: true } } },
  "base-station": { options: { cars: { default: "2", always: true } } },
};

// Which option a dropped file is for, by the end of its name; companions of a world's file have none.
export function optionFor(name, options) {
  const has = (option) => options.some((known) => known.name === option);
  const end = name.toLowerCase().split(".").pop();
  if (end === "robi") return "robot";
  if (["png", "jpg", "jpeg", "bmp", "pgm"].includes(end)) return has("input") ? "input" : null;
  if (has("track") && ["csv", "yaml", "yml", "json", "txt", "sdf"].includes(end)) return "track";
  if (["sim", "wld", "maz", "yaml", "yml", "map", "maze", "txt", "num"].includes(end)) return "world";
  return null;
}

// Of several files, the one that names the others comes first.
export const RANK = ["sim", "yaml", "yml", "wld", "maz", "map", "maze", "txt", "num", "csv", "robi"];
