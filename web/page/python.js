// Runs one program in Python, which calls RoBIOS in a module. First the page says what Python is made of, and hears {ready: true}
// once it is there; then it sends the run, and hears what worker.js tells. Begins with batches.js and Pyodide.
let pyodide = null;

onmessage = ({ data }) => (data.python ? prepare(data.python) : run(data)).catch((error) => postMessage({ failed: String(error.message ?? error) }));

// Pyodide asks for its files by addresses, but nothing is fetched.
async function prepare({ wasm, library, lock, sources }) {
  const answers = { "pyodide.asm.wasm": [wasm, "application/wasm"], "python_stdlib.zip": [library, "application/zip"] };
  globalThis.fetch = async (address) => {
    const [bytes, type] = answers[String(address).split("/").pop()] ?? [];
    if (!bytes) throw new Error(`${address}: not in the page`);
    return new Response(bytes, { headers: { "Content-Type": type } });
  };
  // The iteration order of Python's sets is reproducible, as under the runner.
  const env = { HOME: "/home/robot", PYTHONHASHSEED: "0" };
  pyodide = await loadPyodide({ indexURL: "https://page.invalid/", createPyodideModule: _createPyodideModule, lockFileContents: lock, env });
  pyodide.FS.mkdirTree("/lib/robios");
  for (const [name, text] of Object.entries(sources)) pyodide.FS.writeFile(`/lib/robios/${name}`, text);
  pyodide.runPython('import sys; sys.path.insert(0, "/lib/robios")');
  postMessage({ ready: true });
}

async function run({ module, job, files, text, name, seed }) {
  let exports, timers, over = false;
  const { tell, flush } = batches(() => exports.memory);
  const finish = (status, words) => {
    if (over) return;
    over = true;
    give(exports, words);
    exports.finish(status);
    flush();
    // Whatever the program does now, the page need not wait for it.
    postMessage({ ended: true });
  };
  const stop = () => {
    finish(0, "");
    throw new Error("the run is over");
  };
  exports = (await WebAssembly.instantiate(module, { page: { tell, stop, call_timer: (number) => timers(number) } })).exports;
  openFiles(exports, files);
  give(exports, job);
  if (exports.begin() !== 0) {
    flush();
    postMessage({ ended: true });
    return;
  }
  const printed = { batched: (line) => { give(exports, line); exports.printed(); } };
  pyodide.setStdout(printed);
  pyodide.setStderr(printed);
  pyodide.registerJsModule("eyesim", { exports, view: (start, length) => new Uint8Array(exports.memory.buffer, start, length) });
  const page = pyodide.pyimport("eyesim_page");
  timers = page.call_timer;
  const [status, words] = page.run(text, name, seed).toJs();
  finish(status, words);
}
