// Programs in Python: the second file, which has Python and the module of RoBIOS, and its workers.
import { unpacked } from "./runner.js";

const FILE = "roverlab-programs.js";

// Programs as one more system, with options of `robios`.
export const PROGRAM = {
  name: "program",
  about: "A program in Python that calls RoBIOS, as on an EyeBot",
  options: [
    { name: "seed", kind: "number", default: "1", help: "Seed of all random streams" },
    { name: "noise", kind: "number", default: "0", help: "0 ideal, 1 as on the real robot" },
    { name: "time-limit", kind: "number", default: "3600", value: "S", help: "Simulated time limit" },
    { name: "keys", kind: "text", default: "AUTO", help: "AUTO, NONE, or presses such as KEY1@2s,KEY4@60s" },
    { name: "robot", kind: "choice", default: null, choices: ["S4", "LabBot", "SoccerBot", "LidarBot", "Omni", "Ackermann"], help: "The robot" },
    { name: "start", kind: "text", default: null, value: "X,Y,DEG", help: "Start pose" },
    { name: "world", kind: "text", default: null, help: "A world's file" },
  ],
};

// The options that a program asks for in a line such as `# robios --world=maze.maz`.
export function optionsIn(text) {
  const [, words = ""] = /^# robios (.*)$/m.exec(text) ?? [];
  return Object.fromEntries(words.trim().split(/\s+/).filter(Boolean).map((word) => word.replace(/^--/, "").split(/=(.*)/s)));
}

export class Programs {
  // Loads the second file, which lies beside the page. A script is loaded from disk as well.
  static async load() {
    await new Promise((resolve, reject) => {
      const script = document.createElement("script");
      script.src = FILE;
      script.onload = resolve;
      script.onerror = () => reject(new Error(`${FILE}: not found; expected it beside this page`));
      document.head.append(script);
    });
    const { python, module, menu, worlds, editor } = globalThis.roverlabPrograms;
    const programs = new Programs();
    Object.assign(programs, { menu, worlds, editor, queue: Promise.resolve() });
    const source = await unpacked(python.worker);
    programs.source = URL.createObjectURL(new Blob([source], { type: "text/javascript" }));
    programs.python = { ...python, worker: undefined, wasm: await unpacked(python.wasm), library: await unpacked(python.library) };
    programs.module = await WebAssembly.compile(await unpacked(module));
    programs.spare = programs.prepare();
    return programs;
  }

  // A worker, and when Python is ready in it. Each runs one program, so that none sees what another has left.
  prepare() {
    const worker = new Worker(this.source);
    const ready = new Promise((resolve, reject) => {
      worker.onmessage = ({ data }) => (data.ready ? resolve() : reject(new Error(data.failed)));
      worker.onerror = (event) => reject(new Error(event.message || "the worker could not be started"));
    });
    worker.postMessage({ python: this.python });
    // Who starts a program hears of a failure.
    ready.catch(() => {});
    return { worker, ready };
  }

  // Begins a program: {job, text, name, seed}. `hear` is called with each batch, `end` with null or why it failed.
  async start({ job, text, name, seed }, files, hear, end) {
    this.stop();
    const { worker, ready } = this.spare;
    this.worker = worker;
    this.spare = null;
    const over = (failed) => {
      if (this.worker !== worker) return;
      this.stop();
      end(failed);
    };
    try {
      await ready;
    } catch (error) {
      return over(error.message);
    }
    if (this.worker !== worker) return;
    worker.onmessage = ({ data }) => {
      if (this.worker !== worker) return;
      if (data.bytes) hear(data.bytes, data.entries);
      else over(data.failed ?? null);
    };
    worker.onerror = (event) => over(event.message || "the worker failed");
    const worlds = Object.entries(this.worlds).map(([file, content]) => [file, new TextEncoder().encode(content)]);
    worker.postMessage({ module: this.module, job, files: [...worlds, ...files], text, name, seed });
  }

  // Ends the program, whatever it does. The next one's Python is loaded meanwhile.
  stop() {
    this.worker?.terminate();
    this.worker = null;
    this.spare ??= this.prepare();
  }

  get busy() {
    return this.worker != null;
  }
}

// The editor: CodeMirror where the second file has it, else the plain text area. Returns how to read and write its text.
export function edit(area, { script, style }, run) {
  if (!script) {
    area.addEventListener("keydown", (event) => { if (event.key === "Enter" && event.ctrlKey) run(); });
    return { get: () => area.value, set: (text) => { area.value = text; } };
  }
  for (const [tag, content] of [["style", style], ["script", script]]) {
    const element = document.createElement(tag);
    element.textContent = content;
    document.head.append(element);
  }
  const editor = globalThis.CodeMirror.fromTextArea(area, {
    mode: "python", lineNumbers: true, lineWrapping: true, indentUnit: 4, inputStyle: "contenteditable", screenReaderLabel: "Text of the program",
    // Tab leaves the editor, for those who have no mouse.
    extraKeys: { "Ctrl-Enter": run, "Cmd-Enter": run, Tab: false, "Shift-Tab": false },
  });
  return { get: () => editor.getValue(), set: (text) => { editor.setValue(text); editor.refresh(); } };
}
