// Runs one job of the module, and sends on what it tells: {bytes, entries: [[message, start, length], ...]}, then {ended: true}.
// What goes wrong is {failed: why}. The page ends the worker when it wants another run.
const BATCH = 1 << 18;
const PAUSE = 12;
const MOST = 6e8;

onmessage = async ({ data: { module, job, files } }) => {
  let bytes = new Uint8Array(BATCH), used = 0, entries = [], last = performance.now(), total = 0, exports;
  const flush = () => {
    if (entries.length === 0) return;
    const sent = bytes.slice(0, used).buffer;
    postMessage({ bytes: sent, entries }, [sent]);
    used = 0;
    entries = [];
    last = performance.now();
  };
  const tell = (message, start, length) => {
    if (used + length > bytes.length) {
      flush();
      if (length > bytes.length) bytes = new Uint8Array(2 * length);
    }
    bytes.set(new Uint8Array(exports.memory.buffer, start, length), used);
    entries.push([message, used, length]);
    used += length;
    total += length;
    if (total > MOST) throw new Error(`the run has come to ${MOST / 1e6} MB; set a time limit`);
    if (performance.now() - last > PAUSE) flush();
  };
  const give = (content) => {
    // Memory may grow, and be another buffer then.
    const start = exports.room(content.length);
    new Uint8Array(exports.memory.buffer, start, content.length).set(content);
  };
  try {
    exports = (await WebAssembly.instantiate(module, { page: { tell } })).exports;
    for (const [name, content] of files) {
      const head = new TextEncoder().encode(`${name}\n`);
      const whole = new Uint8Array(head.length + content.byteLength);
      whole.set(head);
      whole.set(new Uint8Array(content), head.length);
      give(whole);
      exports.open_file();
    }
    if (job === null) {
      exports.options();
    } else {
      give(new TextEncoder().encode(job));
      exports.run();
    }
    flush();
    postMessage({ ended: true });
  } catch (error) {
    flush();
    postMessage({ failed: String(error.message ?? error) });
  }
};
