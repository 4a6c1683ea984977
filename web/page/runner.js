// Loads the module, and runs jobs in workers: one at a time, and the newest wins.

export const MESSAGE = { scene: 1, frame: 2, told: 3, ended: 4, panicked: 5, picture: 6, options: 7, overlay: 8, beside: 9 };

// In one file with the page, module and worker are elements; beside it, they are files.
async function loaded(id, file) {
  const element = document.getElementById(id);
  if (!element) return new Uint8Array(await (await fetch(file)).arrayBuffer());
  return unpacked(element.textContent);
}

// Bytes of their deflated form in Base64.
export async function unpacked(text) {
  const packed = Uint8Array.from(atob(text.trim()), (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

export class Runner {
  static async load() {
    const runner = new Runner();
    const element = document.getElementById("worker-source");
    runner.source = element ? URL.createObjectURL(new Blob([element.textContent], { type: "text/javascript" })) : "worker.js";
    runner.module = await WebAssembly.compile(await loaded("module", "roverlab.wasm"));
    return runner;
  }

  // Begins a job, a text of JSON or null for the options. `hear` is called with each batch, `end` with null or why it failed.
  start(job, files, hear, end) {
    this.stop();
    const worker = new Worker(this.source);
    this.worker = worker;
    const over = (failed) => {
      if (this.worker !== worker) return;
      this.stop();
      end(failed);
    };
    worker.onmessage = ({ data }) => {
      if (this.worker !== worker) return;
      if (data.bytes) hear(data.bytes, data.entries);
      else over(data.failed ?? null);
    };
    worker.onerror = (event) => over(event.message || "the worker could not be started");
    worker.postMessage({ module: this.module, job, files: [...files] });
  }

  stop() {
    this.worker?.terminate();
    this.worker = null;
  }

  get busy() {
    return this.worker != null;
  }
}
