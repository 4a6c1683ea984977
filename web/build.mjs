#!/usr/bin/env node
// Builds the page: one file with everything in it.
// Usage: web/build.mjs [FILE [MODULE]]   [default: target/web/roverlab.html, and a module that is compiled]
// Needs Rust's target wasm32-unknown-unknown, and Node.js 18.
import { execFileSync } from "node:child_process";
import { mkdirSync, readFileSync, statSync, writeFileSync } from "node:fs";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { deflateRawSync, gzipSync } from "node:zlib";

const here = dirname(fileURLToPath(import.meta.url)), root = resolve(here, "..");
const target = resolve(root, process.env.CARGO_TARGET_DIR ?? "target");
const out = resolve(process.argv[2] ?? join(target, "web", "roverlab.html"));

// The least that every browser of the last years has.
const FEATURES = ["bulk-memory", "mutable-globals", "nontrapping-fptoint", "sign-ext", "simd128"];

function compiled() {
  execFileSync("cargo", ["build", "--profile", "web", "--lib", "-p", "roverlab-web", "--target", "wasm32-unknown-unknown"], {
    cwd: root, stdio: ["ignore", "inherit", "inherit"],
    env: { ...process.env, RUSTFLAGS: `-Ctarget-feature=${FEATURES.map((name) => `+${name}`).join(",")}` },
  });
  return join(target, "wasm32-unknown-unknown", "web", "roverlab_web.wasm");
}

function page(name) {
  return readFileSync(join(here, "page", name), "utf8");
}

// The modules that one imports, each before those that need it, as one script.
function bundled(name, done = new Set()) {
  if (done.has(name)) return "";
  done.add(name);
  const text = page(name);
  const before = [...text.matchAll(/^import .* from "\.\/(.*)";$/gm)].map(([, other]) => bundled(other, done));
  return before.join("") + text.replace(/^import .*\n/gm, "").replace(/^export /gm, "");
}

// Nothing inside of a script element may look like its end.
function inert(text) {
  return text.replace(/<\/(script)/gi, "<\\/$1").replace(/<!--/g, "<\\!--");
}

// A module without the names of its functions and of the tools that made it.
function nameless(module) {
  const number = (at) => {
    let value = 0, shift = 0, byte;
    do {
      byte = module[at++];
      value += (byte & 127) * 2 ** shift;
      shift += 7;
    } while (byte > 127);
    return [value, at];
  };
  const kept = [module.subarray(0, 8)];
  for (let at = 8; at < module.length;) {
    const [length, content] = number(at + 1), end = content + length;
    if (module[at] !== 0) kept.push(module.subarray(at, end));
    at = end;
  }
  return Buffer.concat(kept);
}

mkdirSync(dirname(out), { recursive: true });
const module = nameless(readFileSync(process.argv[3] ?? compiled()));
const packed = deflateRawSync(module, { level: 9 });
const parts = [
  ['<link rel="stylesheet" href="style.css">', `<style>\n${page("style.css")}</style>`],
  ['<script type="module" src="main.js"></script>', [
    `<script type="application/octet-stream" id="module">${packed.toString("base64")}</script>`,
    `<script type="text/plain" id="worker-source">${inert(page("worker.js"))}</script>`,
    `<script type="module">\n${inert(bundled("main.js"))}</script>`,
  ].join("\n")],
];
let html = page("index.html");
for (const [element, inlined] of parts) {
  if (!html.includes(element)) throw new Error(`page/index.html: found no ${element}`);
  html = html.replace(element, () => inlined);
}
writeFileSync(out, html);
const kilobytes = (bytes) => `${Math.round(bytes / 1000)} kB`;
console.log(`${out}: ${kilobytes(statSync(out).size)}, ${kilobytes(gzipSync(html, { level: 9 }).length)} gzipped; module ${kilobytes(module.length)}`);
