#!/usr/bin/env node
// Builds the page: one file with everything in it, and beside it one with what programs in Python need.
// Usage: web/build.mjs [FILE [MODULE [PROGRAMS]]]   [default: target/web/roverlab.html, and modules that are compiled]
// Needs Rust's target wasm32-unknown-unknown, and Node.js 18. After `npm ci --prefix web`, the modules are smaller, and there is
// the second file.
import { execFileSync } from "node:child_process";
import { copyFileSync, existsSync, mkdirSync, readFileSync, readdirSync, statSync, writeFileSync } from "node:fs";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { deflateRawSync, gzipSync } from "node:zlib";

const here = dirname(fileURLToPath(import.meta.url)), root = resolve(here, "..");
const target = resolve(root, process.env.CARGO_TARGET_DIR ?? "target");
const out = resolve(process.argv[2] ?? join(target, "web", "roverlab.html"));
const packages = join(here, "node_modules");
const hasPrograms = existsSync(join(packages, "pyodide"));

// The least that every browser of the last years has.
const FEATURES = ["bulk-memory", "mutable-globals", "nontrapping-fptoint", "sign-ext", "simd128"];

// The module for commands or for programs, as small as can be here.
function compiled(kind) {
  const options = ["--profile", "web", "--lib", "-p", "roverlab-web", ...(kind === "programs" ? ["--features", kind] : [])];
  execFileSync("cargo", ["rustc", ...options, "--crate-type", "cdylib", "--target", "wasm32-unknown-unknown"], {
    cwd: root, stdio: ["ignore", "inherit", "inherit"],
    env: { ...process.env, RUSTFLAGS: `-Ctarget-feature=${FEATURES.map((name) => `+${name}`).join(",")}` },
  });
  const module = join(target, "web", `${kind}.wasm`);
  mkdirSync(dirname(module), { recursive: true });
  copyFileSync(join(target, "wasm32-unknown-unknown", "web", "roverlab_web.wasm"), module);
  const optimizer = join(packages, "binaryen", "bin", "wasm-opt");
  if (existsSync(optimizer)) {
    const enabled = FEATURES.map((name) => `--enable-${name.replace("fptoint", "float-to-int").replace("simd128", "simd")}`);
    execFileSync(process.execPath, [optimizer, ...enabled, "-Oz", module, "-o", module], { stdio: ["ignore", "inherit", "inherit"] });
  }
  return module;
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

const inBase64 = (bytes) => deflateRawSync(bytes, { level: 9 }).toString("base64");
const kilobytes = (bytes) => `${Math.round(bytes / 1000)} kB`;

function write(file, text, module) {
  writeFileSync(file, text);
  const sizes = `${kilobytes(statSync(file).size)}, ${kilobytes(gzipSync(text, { level: 9 }).length)} gzipped`;
  console.log(`${file}: ${sizes}; module ${kilobytes(module.length)}`);
}

function writePage(module) {
  const worker = page("batches.js") + page("worker.js");
  const parts = [
    ["<body>", hasPrograms ? "<body data-programs>" : "<body>"],
    ['<link rel="stylesheet" href="style.css">', `<style>\n${page("style.css")}</style>`],
    ['<script type="module" src="main.js"></script>', [
      `<script type="application/octet-stream" id="module">${inBase64(module)}</script>`,
      `<script type="text/plain" id="worker-source">${inert(worker)}</script>`,
      `<script type="module">\n${inert(bundled("main.js"))}</script>`,
    ].join("\n")],
  ];
  let html = page("index.html");
  for (const [element, inlined] of parts) {
    if (!html.includes(element)) throw new Error(`page/index.html: found no ${element}`);
    html = html.replace(element, () => inlined);
  }
  write(out, html, module);
}

// Texts of a folder, by their names.
function texts(folder, ending) {
  const names = readdirSync(folder).filter((name) => ending.test(name)).sort();
  return Object.fromEntries(names.map((name) => [name, readFileSync(join(folder, name), "utf8")]));
}

// The programs of the menu: the first line of each says what it does.
function menu() {
  return ["book", "own"].flatMap((folder) => Object.entries(texts(join(here, "programs", folder), /\.py$/)).map(([name, text]) => {
    const [, title] = /^"""(.*?)\.?"""/.exec(text) ?? [];
    if (!title) throw new Error(`programs/${folder}/${name}: found no title; expected one in its first line`);
    return { name: `${folder}/${name}`, title, text };
  }));
}

// Pyodide as one script of a worker. Pages from disk may have no workers that are modules, and Pyodide refuses others, as it would
// import its parts there; here it has all of them.
function pythonWorker(read) {
  const loaded = read("pyodide.asm.mjs").replaceAll("import.meta.url", "self.location.href").replace(/export default \w+;?\s*$/, "");
  return ["self.importScripts = undefined;", loaded, read("pyodide.js"), page("batches.js"), page("python.js")].join("\n");
}

function writePrograms(module) {
  const bytes = (...names) => readFileSync(join(packages, ...names)), read = (name) => bytes("pyodide", name).toString();
  const folder = join(here, "programs"), editor = join(packages, "codemirror"), { info } = JSON.parse(read("pyodide-lock.json"));
  const python = {
    worker: inBase64(pythonWorker(read)), wasm: inBase64(bytes("pyodide", "pyodide.asm.wasm")),
    library: inBase64(bytes("pyodide", "python_stdlib.zip")), lock: { info, packages: {} },
    sources: { ...texts(join(root, "robios", "python"), /\.py$/), ...texts(folder, /\.py$/) },
  };
  const codemirror = existsSync(editor) ? {
    script: ["lib/codemirror.js", "mode/python/python.js"].map((name) => bytes("codemirror", name)).join("\n"),
    style: bytes("codemirror", "lib/codemirror.css").toString(),
  } : {};
  const parts = { python, module: inBase64(module), menu: menu(), worlds: texts(folder, /\.(wld|maz|sim)$/), editor: codemirror };
  write(join(dirname(out), "roverlab-programs.js"), `globalThis.roverlabPrograms = ${JSON.stringify(parts)};\n`, module);
}

mkdirSync(dirname(out), { recursive: true });
const [, , , commands, programs] = process.argv;
writePage(nameless(readFileSync(commands ?? compiled("commands"))));
if (hasPrograms) writePrograms(nameless(readFileSync(programs ?? compiled("programs"))));
else console.log("no programs in the page: npm ci --prefix web has not been run");
