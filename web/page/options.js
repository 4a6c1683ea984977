// The form of a system's options, made of what the commands say of themselves.
import { FIRST, LAST, FILES, OVERRIDES, isShown } from "./systems.js";

// What stands in an empty box.
const UNITS = { S: "s", MM: "mm", DEG: "deg", "M/S": "m/s", "X,Y,DEG": "mm, mm, deg", "X,Y[,DEG]": "mm, mm", "KIND@T": "stuck@5" };

// The options of a command as the page has them.
export function optionsOf(command) {
  const own = OVERRIDES[command.name]?.options ?? {};
  return command.options.filter(isShown).map((option) => ({ ...option, ...own[option.name] }));
}

// The words of a command line.
export function wordsOf(command, values) {
  const words = [command.name];
  for (const [name, value] of Object.entries(OVERRIDES[command.name]?.always ?? {})) words.push(`--${name}=${value}`);
  for (const option of optionsOf(command)) {
    const value = values[option.name] ?? (option.always ? option.default : undefined);
    if (value === undefined || value === "") continue;
    if (option.kind === "switch") words.push(`--${option.name}`);
    else words.push(`--${option.name}=${value}`);
  }
  return words;
}

// Fills a form. `change` is called with the name of an option and its new value, undefined for the default one.
export function fill(form, command, values, files, change) {
  const options = optionsOf(command);
  const rank = (option) => {
    const first = FIRST.indexOf(option.name);
    return first >= 0 ? first : LAST.includes(option.name) ? 100 + LAST.indexOf(option.name) : 50;
  };
  const sorted = [...options].sort((a, b) => rank(a) - rank(b));
  const more = document.createElement("details"), box = document.createElement("div"), summary = document.createElement("summary");
  summary.textContent = "More";
  more.append(summary, box);
  more.open = sorted.some((option) => rank(option) >= 100 && values[option.name] !== undefined);
  form.replaceChildren();
  for (const option of sorted) (rank(option) >= 100 ? box : form).append(field(option, values[option.name], files, change));
  if (box.children.length) form.append(more);
}

function field(option, value, files, change) {
  const label = document.createElement("label"), name = document.createElement("span");
  name.textContent = option.name.replaceAll("-", " ");
  label.title = option.help ?? "";
  label.append(name);
  const input = control(option, value, files);
  input.name = option.name;
  input.addEventListener("change", () => {
    if (option.kind === "switch") change(option.name, input.checked ? "" : undefined, input.checked);
    else change(option.name, input.value === "" || input.value === option.default ? undefined : input.value);
  });
  if (option.kind === "switch") label.className = "switch";
  label.append(input);
  return label;
}

function control(option, value, files) {
  if (option.kind === "switch") {
    const box = document.createElement("input");
    box.type = "checkbox";
    box.checked = value !== undefined;
    return box;
  }
  if (option.kind === "choice" || FILES.includes(option.name)) {
    const select = document.createElement("select");
    const choices = option.kind === "choice" ? option.choices : [...files.keys()];
    if (option.default == null) select.add(new Option(FILES.includes(option.name) ? "its own" : "by itself", ""));
    for (const choice of choices) select.add(new Option(choice, choice));
    select.value = value ?? option.default ?? "";
    return select;
  }
  const box = document.createElement("input");
  box.type = option.kind === "number" ? "number" : "text";
  if (option.kind === "number") box.step = "any";
  if (option.name === "seed") [box.step, box.min] = ["1", "0"];
  if (option.name === "noise") [box.step, box.min, box.max] = ["0.5", "0", "5"];
  box.placeholder = UNITS[option.value] ?? "";
  box.value = value ?? option.default ?? "";
  return box;
}
