// Runs one job of the module, and sends on what it tells, in batches, then {ended: true}. What goes wrong is {failed: why}.
// The page ends the worker when it wants another run. In one file with the page, it begins with batches.js.
if (typeof batches === "undefined") importScripts("batches.js");

onmessage = async ({ data: { module, job, files } }) => {
  let exports;
  const { tell, flush } = batches(() => exports.memory);
  try {
    exports = (await WebAssembly.instantiate(module, { page: { tell } })).exports;
    openFiles(exports, files);
    if (job === null) {
      exports.options();
    } else {
      give(exports, job);
      exports.run();
    }
    flush();
    postMessage({ ended: true });
  } catch (error) {
    flush();
    postMessage({ failed: String(error.message ?? error) });
  }
};
