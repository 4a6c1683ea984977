// Where programs are written: the menu, the editor, and the program that runs.
import { Programs, edit, optionsIn } from "./programs.js";

const GROUPS = { book: "In the manner of the book", own: "And others" };

export class Desk {
  // `run` is the page's, `begin` runs what the editor has, `again` opens what `run` has.
  constructor({ run, area, menu, begin, again }) {
    Object.assign(this, { run, area, menu, begin, again, programs: null, editor: null });
    menu.addEventListener("change", () => this.choose(menu.value));
  }

  get isLoaded() {
    return this.editor !== null;
  }

  get busy() {
    return this.programs?.busy ?? false;
  }

  get worlds() {
    return Object.entries(this.programs?.worlds ?? {});
  }

  // Shows the program that the run names, or its own text. Fails if Python cannot be had.
  async open() {
    this.loading ??= this.load();
    await this.loading;
    const { values } = this.run, known = this.known();
    if (!known && values.text === undefined) Object.assign(values, this.fresh(this.programs.menu[0]));
    if (known && Object.keys(values).length === 1) Object.assign(values, this.fresh(known));
    values.program ??= "program.py";
    this.menu.value = this.known() && values.text === undefined ? values.program : "";
    this.editor.set(values.text ?? this.known().text);
  }

  async load() {
    this.programs = await Programs.load();
    const groups = Object.entries(GROUPS).map(([folder, label]) => {
      const group = document.createElement("optgroup");
      group.label = label;
      for (const { name, title } of this.programs.menu) if (name.startsWith(`${folder}/`)) group.append(new Option(title, name));
      return group;
    });
    this.menu.replaceChildren(new Option("Your own", ""), ...groups);
    this.editor = edit(this.area, this.programs.editor, this.begin);
  }

  known() {
    return this.programs.menu.find(({ name }) => name === this.run.values.program);
  }

  fresh({ name, text }) {
    return { program: name, ...optionsIn(text) };
  }

  choose(name) {
    const known = this.programs.menu.find((other) => other.name === name), text = this.editor.get();
    const values = known ? this.fresh(known) : { program: "program.py", text, ...optionsIn(text) };
    Object.assign(this.run, { values, wishes: [], walls: [] });
    this.again();
  }

  // The program as it is in the menu, with its own options.
  reset() {
    this.choose(this.known()?.name ?? "");
  }

  // Takes the text of the editor; a link holds it unless it is that of the menu.
  take() {
    const text = this.editor.get(), { values } = this.run;
    if (text === this.known()?.text) delete values.text;
    else values.text = text;
    this.menu.value = values.text === undefined ? values.program : "";
  }

  // Runs the program. Returns the command line that does the same.
  start(job, files, hear, end) {
    const { values } = this.run, [, ...options] = job.words, name = values.program;
    const request = { job: JSON.stringify({ ...job, words: [name, ...options] }), text: this.editor.get(), name, seed: values.seed ?? "1" };
    this.programs.start(request, files, hear, end);
    return ["robios", ...options, name].join(" ");
  }

  stop() {
    this.programs?.stop();
  }

  // Presses a key at a time (s): keys are an option. Returns whether what was before stays as it is.
  press(key, time) {
    const { values } = this.run, before = values.keys ?? "AUTO", isScript = before.includes("@");
    const kept = isScript ? before.split(",").filter((press) => Number(/@([\d.]+)/.exec(press)?.[1]) < time) : [];
    values.keys = [...kept, `KEY${key}@${time}s`].join(",");
    return isScript;
  }
}
