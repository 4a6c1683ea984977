// A run as the part of an address behind `#`: `distbug?seed=3&noise=0`, with what hands have done.

export function toHash({ command, values, wishes, walls }) {
  const query = new URLSearchParams(Object.entries(values));
  if (wishes.length) query.set("hands", JSON.stringify(wishes));
  if (walls.length) query.set("walls", JSON.stringify(walls));
  const text = query.toString();
  return `#${command}${text ? `?${text}` : ""}`;
}

// Nothing is trusted: what makes no sense is left out.
export function fromHash(hash) {
  const [command, query = ""] = decodeHash(hash).split(/\?(.*)/s);
  const values = Object.fromEntries(new URLSearchParams(query));
  const list = (name) => {
    const text = values[name];
    delete values[name];
    try {
      const found = JSON.parse(text ?? "[]");
      return Array.isArray(found) ? found : [];
    } catch {
      return [];
    }
  };
  return { command, values, wishes: list("hands"), walls: list("walls") };
}

function decodeHash(hash) {
  return hash.replace(/^#/, "");
}
