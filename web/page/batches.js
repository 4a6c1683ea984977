// What a module tells, in batches: {bytes, entries: [[message, start, length], ...]}; and what it is given.
const BATCH = 1 << 18;
const PAUSE = 12;
const MOST = 6e8;

function batches(memory) {
  let bytes = new Uint8Array(BATCH), used = 0, entries = [], last = performance.now(), total = 0;
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
    bytes.set(new Uint8Array(memory().buffer, start, length), used);
    entries.push([message, used, length]);
    used += length;
    total += length;
    if (total > MOST) throw new Error(`the run has come to ${MOST / 1e6} MB; set a time limit`);
    if (performance.now() - last > PAUSE) flush();
  };
  return { tell, flush };
}

// Puts a text or bytes into the module's room.
function give(exports, content) {
  const bytes = typeof content === "string" ? new TextEncoder().encode(content) : content;
  // Memory may grow, and be another buffer then.
  const start = exports.room(bytes.length);
  new Uint8Array(exports.memory.buffer, start, bytes.length).set(bytes);
}

function openFiles(exports, files) {
  for (const [name, content] of files) {
    const head = new TextEncoder().encode(`${name}\n`);
    const whole = new Uint8Array(head.length + content.byteLength);
    whole.set(head);
    whole.set(new Uint8Array(content), head.length);
    give(exports, whole);
    exports.open_file();
  }
}
