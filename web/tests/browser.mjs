// Tests of the page in a browser without a window: PAGE=FILE node --test web/tests/browser.mjs; PICTURES=FOLDER keeps pictures.
// Needs `npm ci --prefix web/tests`, and Chromium: `chromium`, or what CHROMIUM names.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { existsSync, mkdirSync, readFileSync } from "node:fs";
import { dirname, join, resolve } from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath, pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

const here = dirname(fileURLToPath(import.meta.url));
const PAGE = pathToFileURL(resolve(process.env.PAGE ?? "target/web/roverlab.html")).href;
const PICTURES = process.env.PICTURES;
// What a browser without a window needs on machines of all kinds, and nothing that talks to the network.
const ARGUMENTS = [
  "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
  "--disable-component-update", "--disable-sync",
];
const DESKTOP = { width: 1280, height: 800 }, PHONE = { width: 390, height: 844 };
// Runs are made of a line each: the words of a command line, and the digest of what the page shows of it.
const RUNS = readFileSync(join(here, "digests.txt"), "utf8").split("\n").filter((line) => line && !line.startsWith("#"))
  .map((line) => ({ words: line.split(" ").slice(0, -1), digest: line.split(" ").at(-1) }));
// What the runner says of programs: their names, and its JSON.
const PROGRAMS = readFileSync(join(here, "programs.txt"), "utf8").trim().split("\n")
  .map((line) => ({ name: line.split(" ", 1)[0], report: JSON.parse(line.slice(line.indexOf(" "))) }));
// Programs need the second file, which is built where Pyodide is.
const WITHOUT_PYTHON = existsSync(join(dirname(fileURLToPath(PAGE)), "roverlab-programs.js")) ? false : "there is no roverlab-programs.js";

// Chromium, by its path or by its name.
function executable() {
  return execFileSync("sh", ["-c", 'command -v "$0"', process.env.CHROMIUM ?? "chromium"], { encoding: "utf8" }).trim();
}

let browser;
before(async () => {
  browser = await chromium.launch({ executablePath: executable(), args: ARGUMENTS });
});
after(() => browser?.close());

// A page that fails the test if it complains.
async function open(hash, options = {}) {
  const context = await browser.newContext({ viewport: DESKTOP, ...options });
  context.setDefaultTimeout(PATIENCE);
  const page = await context.newPage();
  page.complaints = [];
  page.on("console", (message) => { if (message.type() === "error") page.complaints.push(message.text()); });
  page.on("pageerror", (error) => page.complaints.push(error.message));
  await page.goto(PAGE + hash);
  return page;
}

async function close(page) {
  assert.deepEqual(page.complaints, []);
  await page.context().close();
}

// Long enough for a machine that is busy with other things: what takes longer hangs.
const PATIENCE = 600_000;

const state = (page) => page.evaluate(() => window.roverlab.state);
const until = (page, what) => page.waitForFunction(what, null, { polling: 50 });
const over = (page) => until(page, () => window.roverlab?.state.ended && !window.roverlab.state.busy);

// Where something of the world is on the screen.
async function onScreen(page, place) {
  const box = await page.locator("#stage").boundingBox();
  const [x, y] = await page.evaluate((place) => window.roverlab.view.toScreen(place), place);
  return [box.x + x, box.y + y];
}

const poseAt = (page, time) => page.evaluate((time) => {
  const { recording } = window.roverlab;
  return recording.robotAt(recording.index(time), 0).pose;
}, time);

async function drag(page, from, to) {
  await page.mouse.move(...from);
  await page.mouse.down();
  await page.mouse.move((from[0] + to[0]) / 2, (from[1] + to[1]) / 2);
  await page.mouse.move(...to);
  await page.mouse.up();
}

async function pause(page, time) {
  await over(page);
  await page.evaluate((time) => { window.roverlab.pause(); window.roverlab.seek(time); }, time);
  await page.waitForTimeout(100);
}

// How many colours there are in what is drawn.
const colours = (page, canvas) => page.evaluate((canvas) => {
  const element = document.getElementById(canvas), { data } = element.getContext("2d").getImageData(0, 0, element.width, element.height);
  const found = new Set();
  for (let at = 0; at < data.length; at += 4) found.add((data[at] << 16) | (data[at + 1] << 8) | data[at + 2]);
  return found.size;
}, canvas);

async function keep(page, name) {
  if (!PICTURES) return;
  mkdirSync(PICTURES, { recursive: true });
  await page.screenshot({ path: join(PICTURES, `${name}.png`) });
}

for (const { words, digest } of RUNS) {
  const name = words[0];
  test(`${name} opens, runs, and has the bits of the native run`, async () => {
    const page = await open(`#${name}`);
    await over(page);
    const { ended, frames } = await state(page);
    assert.equal(await page.evaluate(() => document.getElementById("command").textContent), `roverlab ${words.join(" ")}`);
    assert.ok(ended.status <= 1 && ended.output, `${name}: ${ended.errors}`);
    assert.ok(frames > 0);
    assert.equal(ended.digest, digest);
    await pause(page, (await state(page)).end * 0.6);
    assert.ok(await colours(page, "stage") > 20, "something is drawn");
    await keep(page, `${name}-light`);
    await page.emulateMedia({ colorScheme: "dark" });
    await page.waitForTimeout(150);
    await keep(page, `${name}-dark`);
    await page.setViewportSize(PHONE);
    await page.evaluate(() => document.getElementById("fit").click());
    await page.waitForTimeout(150);
    const [wide, seen] = await page.evaluate(() => [document.documentElement.scrollWidth, innerWidth]);
    assert.ok(wide <= seen, `nothing sticks out of a phone: ${wide} in ${seen} pixels`);
    await keep(page, `${name}-phone`);
    await close(page);
  });
}

test("every system of the command line that drives a robot is listed", async () => {
  const page = await open("#distbug");
  await over(page);
  const listed = await page.evaluate(() => [...document.querySelectorAll("#systems a")].map((link) => link.dataset.command));
  const tested = RUNS.map(({ words }) => words[0]);
  assert.deepEqual(listed.filter((name) => name !== "program").sort(), [...new Set(tested)].sort());
  await close(page);
});

test("the first picture comes soon, and time is played, stopped and stepped", async () => {
  const page = await open("#distbug");
  await until(page, () => window.roverlab?.state.frames > 0);
  await until(page, () => window.roverlab.state.time > 1);
  await page.keyboard.press(" ");
  const { time, playing } = await state(page);
  assert.ok(!playing);
  await page.waitForTimeout(200);
  assert.equal((await state(page)).time, time);
  await page.keyboard.press("ArrowRight");
  assert.ok(Math.abs((await state(page)).time - time - 0.04) < 1e-9);
  await page.keyboard.press("Home");
  assert.equal((await state(page)).time, 0);
  await page.click("#play");
  await until(page, () => window.roverlab.state.time > 0.5);
  await close(page);
});

test("any moment comes again as soon as the next one, and is what it was", async (context) => {
  const page = await open("#distbug");
  await over(page);
  const before = await poseAt(page, 20);
  const [far, near] = await page.evaluate(async () => {
    const median = async (times) => {
      const taken = [];
      for (const time of times) {
        const begin = performance.now(), drawn = window.roverlab.drawn;
        window.roverlab.seek(time);
        while (window.roverlab.drawn === drawn) await new Promise(requestAnimationFrame);
        taken.push(performance.now() - begin);
      }
      return taken.sort((a, b) => a - b)[times.length >> 1];
    };
    const steps = Array.from({ length: 15 }, (_, step) => 30 + step / 25);
    return [await median([50, 20, 60, 1, 40, 5, 55, 30, 10, 59, 2, 45, 15, 35, 20]), await median(steps)];
  });
  context.diagnostic(`${far.toFixed(1)} ms, the next moment ${near.toFixed(1)} ms`);
  assert.ok(far < 5 * near, `${far} ms, and the next moment ${near} ms`);
  assert.deepEqual(await poseAt(page, 20), before);
  await page.locator("#slider").fill("10");
  assert.ok(Math.abs((await state(page)).time - 10) < 0.05);
  await close(page);
});

test("a robot is carried away in the middle of a run, and what was before stays", async () => {
  const page = await open("#distbug");
  await pause(page, 5);
  const before = await poseAt(page, 4.9), here = await poseAt(page, 5);
  await drag(page, await onScreen(page, here), await onScreen(page, [3.2, 0.6]));
  await over(page);
  const { wishes } = await state(page);
  assert.equal(wishes.length, 1);
  assert.deepEqual(await poseAt(page, 4.9), before);
  const [x, y] = await poseAt(page, 5.1);
  assert.ok(Math.hypot(x - 3.2, y - 0.6) < 0.15, `it is at ${x}, ${y}`);
  await close(page);
});

test("goal, start and things are dragged", async () => {
  const page = await open("#distbug");
  await pause(page, 0);
  const goal = await page.evaluate(() => window.roverlab.recording.scene.markers[0].at);
  await drag(page, await onScreen(page, goal), await onScreen(page, [1.0, 2.0]));
  await over(page);
  assert.match((await state(page)).values.goal, /^(99\d|100\d),(199\d|200\d)$/);
  await pause(page, 0);
  await drag(page, await onScreen(page, [0.5, 0.5]), await onScreen(page, [0.5, 1.2]));
  await over(page);
  assert.match((await state(page)).values.start, /^(49\d|50\d),(119\d|120\d),0$/);
  await pause(page, 1);
  const can = await page.evaluate(() => window.roverlab.recording.scene.objects.findIndex(({ name }) => name === "can"));
  const { pose } = await page.evaluate((can) => window.roverlab.recording.scene.objects[can], can);
  await drag(page, await onScreen(page, pose), await onScreen(page, [3.0, 1.0]));
  await over(page);
  const moved = await page.evaluate((can) => {
    const { recording } = window.roverlab;
    return recording.objects(recording.index(2)).get(can).pose;
  }, can);
  assert.ok(Math.hypot(moved[0] - 3.0, moved[1] - 1.0) < 0.05);
  await close(page);
});

test("a wall that is drawn is in the way", async () => {
  const page = await open("#distbug");
  await over(page);
  const { digest } = (await state(page)).ended;
  await page.keyboard.press("w");
  await drag(page, await onScreen(page, [0.7, 1.1]), await onScreen(page, [1.1, 0.7]));
  await over(page);
  const { walls, ended } = await state(page);
  assert.equal(walls.length, 1);
  assert.notEqual(ended.digest, digest);
  await close(page);
});

test("keys are pressed at the moment that is shown", async () => {
  const page = await open("#edges");
  await pause(page, 1);
  await page.keyboard.press("2");
  await over(page);
  assert.deepEqual((await state(page)).wishes.map(({ time, key, of }) => [Math.round(time * 100) / 100, key, of]), [[1, 2, 0]]);
  await page.click("#keys button:nth-child(4)");
  await over(page);
  assert.equal((await state(page)).wishes.length, 2);
  await close(page);
});

test("a world is opened from a file, and dropped", async () => {
  const page = await open("#maze-left");
  const maze = "o---o---o\n|     G |\no   o---o\n| S |   |\no---o---o\n";
  await over(page);
  await page.setInputFiles("#file", { name: "small.maz", mimeType: "text/plain", buffer: Buffer.from(maze) });
  await until(page, () => window.roverlab.state.values.world === "small.maz");
  await over(page);
  let { values, ended } = await state(page);
  assert.equal(values.world, "small.maz");
  assert.match(ended.output, /width +2/);
  const dropped = await page.evaluateHandle(() => {
    const transfer = new DataTransfer();
    transfer.items.add(new File(["o---o---o---o\n| S       G |\no---o---o---o\n"], "row.maz"));
    return transfer;
  });
  await page.dispatchEvent("body", "drop", { dataTransfer: dropped });
  await until(page, () => window.roverlab.state.values.world === "row.maz");
  await over(page);
  ({ values, ended } = await state(page));
  assert.match(ended.output, /width +3/);
  await page.setInputFiles("#file", { name: "broken.maz", mimeType: "text/plain", buffer: Buffer.from("no maze") });
  await until(page, () => window.roverlab.state.ended?.errors);
  assert.match(await page.locator("#notice").textContent(), /broken\.maz/);
  await close(page);
});

test("a link holds scene, seed, options and what hands did", async () => {
  const page = await open("#wall-following?seed=3&controller=lidar");
  await pause(page, 2);
  await drag(page, await onScreen(page, await poseAt(page, 2)), await onScreen(page, [1.0, 1.0]));
  await over(page);
  const { ended, wishes } = await state(page), address = page.url();
  const other = await open(address.slice(address.indexOf("#")));
  await over(other);
  const again = await state(other);
  assert.deepEqual([again.values, again.wishes], [{ seed: "3", controller: "lidar" }, wishes]);
  const end = (page) => page.evaluate(() => { const { recording } = window.roverlab; return recording.robotAt(recording.frames.length - 1, 0); });
  assert.deepEqual(await end(other), await end(page));
  assert.equal(again.ended.output, ended.output);
  await close(other);
  await close(page);
});

test("what makes no sense is refused in words, and the page goes on", async () => {
  const page = await open("#distbug?noise=99");
  await until(page, () => window.roverlab?.state.ended);
  assert.match(await page.locator("#notice").textContent(), /noise/);
  await page.fill("[name=noise]", "0");
  await page.dispatchEvent("[name=noise]", "change");
  await until(page, () => window.roverlab.state.ended?.status === 0);
  for (const hash of ["#nothing", "#distbug?hands=[1", "#distbug?hands=[{}]", "#distbug?walls=7", "#%ff?=&&"]) {
    await page.goto(PAGE + hash);
    await until(page, () => window.roverlab?.state.ended);
  }
  await close(page);
});

test("what is shown can be chosen, the view moved, the theme changed", async () => {
  const page = await open("#distbug");
  await pause(page, 30);
  const scale = () => page.evaluate(() => window.roverlab.view.scale);
  const before = await scale();
  await page.keyboard.press("+");
  assert.ok(await scale() > before);
  await page.mouse.move(...await onScreen(page, [2, 2]));
  await page.mouse.wheel(0, 300);
  await page.keyboard.press("f");
  assert.ok(Math.abs(await scale() - before) < 1);
  await page.click("#layers");
  const boxes = page.locator("#layer-box input");
  assert.ok(await boxes.count() >= 6);
  await boxes.first().click();
  const ground = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
  const light = await ground();
  await page.click("#theme");
  assert.notEqual(await ground(), light);
  await close(page);
});

test("it hurries, and draws smoothly", async (context) => {
  const measure = async (hash) => {
    const page = await open(hash);
    await over(page);
    const found = await page.evaluate(async () => {
      const { state, seek } = window.roverlab, view = window.roverlab.view;
      // The time that drawing takes, without what the browser's screen allows.
      const begin = performance.now();
      let frames = 0;
      for (; performance.now() - begin < 1000; frames++) window.roverlab.drawAt((state.end * (frames % 97)) / 97);
      // The pictures that come while it plays, of at most as many as the screen has.
      window.roverlab.pause();
      window.roverlab.seek(0);
      document.getElementById("play").click();
      const before = window.roverlab.drawn, start = performance.now();
      while (performance.now() - start < 2000) await new Promise(requestAnimationFrame);
      const played = (1000 * (window.roverlab.drawn - before)) / (performance.now() - start);
      return { played, first: state.first, hurry: state.end / state.ended.seconds, frames, scale: view.scale, seek: typeof seek };
    });
    await close(page);
    return found;
  };
  const pictures = [];
  for (const hash of ["#distbug", "#follow-me?followers=99"]) {
    const { first, hurry, frames, played } = await measure(hash);
    context.diagnostic(`${hash}: first picture ${first.toFixed(0)} ms, ${hurry.toFixed(0)} times real time, `
      + `${frames} pictures a second, ${played.toFixed(0)} while it plays`);
    assert.ok(played > 0, `${hash}: nothing was drawn while it played`);
    pictures.push(frames);
  }
  assert.ok(pictures[0] < 100 * pictures[1], `a picture of 100 robots costs more than 100 of one: ${pictures}`);
});

// Runs a program: what its address says of it.
async function runProgram(page, options) {
  await page.evaluate((query) => { location.hash = `program?${query}`; }, new URLSearchParams(options).toString());
  await page.waitForFunction((program) => {
    const { values, ended, busy } = window.roverlab.state;
    return values.program === program && ended && !busy;
  }, options.program, { polling: 50 });
  return (await state(page)).ended;
}

test("programs in Python end as under the runner", { skip: WITHOUT_PYTHON }, async (context) => {
  const page = await open("#distbug");
  await over(page);
  for (const { name, report } of PROGRAMS) {
    const { report: found, seconds } = await runProgram(page, { program: name });
    assert.deepEqual(found, report, name);
    context.diagnostic(`${name}: ${report.sim_time_s} s in ${seconds.toFixed(2)} s`);
  }
  await pause(page, 5);
  assert.ok(await colours(page, "stage") > 20, "something is drawn");
  await keep(page, "program-light");
  await page.emulateMedia({ colorScheme: "dark" });
  await keep(page, "program-dark");
  await page.setViewportSize(PHONE);
  await page.waitForTimeout(150);
  const [wide, seen] = await page.evaluate(() => [document.documentElement.scrollWidth, innerWidth]);
  assert.ok(wide <= seen, `nothing sticks out of a phone: ${wide} in ${seen} pixels`);
  await keep(page, "program-phone");
  await close(page);
});

test("a program that loops for ever is stopped at once", { skip: WITHOUT_PYTHON }, async () => {
  const page = await open("#program?program=a.py&text=from+eye+import+*%0AVWSetSpeed(100,0)%0AOSWait(500)%0Awhile+True:+pass");
  await until(page, () => window.roverlab?.recording);
  const busy = await page.evaluate(() => {
    document.getElementById("halt").click();
    return window.roverlab.state.busy;
  });
  assert.ok(!busy);
  assert.match(await page.locator("#status").textContent(), /stopped/i);
  // The time limit ends what goes on calling, whatever it catches.
  const text = "from eye import *\nwhile True:\n    try:\n        OSWait(100)\n    except:\n        pass\n";
  const { report } = await runProgram(page, { program: "b.py", text, "time-limit": "5" });
  assert.deepEqual([report.outcome, report.sim_time_s], ["timed_out", 5]);
  await close(page);
});

test("a program is written, its errors are told, and its keys are pressed", { skip: WITHOUT_PYTHON }, async () => {
  const page = await open("#program");
  await over(page);
  const failed = await runProgram(page, { program: "c.py", text: "from eye import *\nLCDPrintf('%d', 1 / 0)\n" });
  assert.deepEqual([failed.report.outcome, failed.report.exit, failed.report.error], ["failed", 1, "ZeroDivisionError: division by zero"]);
  const waits = "from eye import *\nLCDMenu('A', 'B', '', '')\nLCDPrintf('%d', KEYGet())\nOSWait(3000)\n";
  assert.equal((await runProgram(page, { program: "d.py", text: waits })).report.lcd_text, "1");
  await page.evaluate(() => { window.roverlab.pause(); window.roverlab.seek(0.5); });
  await page.click("#keys button:nth-child(2)");
  await over(page);
  assert.equal((await state(page)).ended.report.lcd_text, "2");
  await page.selectOption("#which", "book/keys.py");
  await page.waitForFunction(() => window.roverlab.state.values.program === "book/keys.py" && window.roverlab.state.ended && !window.roverlab.state.busy);
  assert.equal((await state(page)).values.text, undefined);
  await close(page);
});
