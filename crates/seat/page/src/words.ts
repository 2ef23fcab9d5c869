// Texts and questionnaires.

import { say } from "./say";

const main = document.getElementById("main") as HTMLElement;

/// An element with text or children; text never becomes markup.
export function make<K extends keyof HTMLElementTagNameMap>(
  tag: K, children: (Node | string)[] = [], properties: Partial<HTMLElementTagNameMap[K]> = {},
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  element.append(...children);
  return Object.assign(element, properties);
}

/// Shows a page of words and takes the reader to its beginning.
export function show(...children: (Node | string)[]): void {
  main.replaceChildren(...children);
  scrollTo(0, 0);
  main.focus();
}

/// Paragraphs divided by empty lines; `#` heads one, `-` begins a point.
export function paragraphs(text: string): HTMLElement[] {
  return text.split(/\n\s*\n/).filter((p) => p.trim()).map((p) => {
    const lines = p.trim().split("\n");
    const first = lines[0] as string;
    if (first.startsWith("#")) return make("h2", [first.replace(/^#+\s*/, "")]);
    if (lines.every((l) => l.startsWith("- "))) return make("ul", lines.map((l) => make("li", [l.slice(2)])));
    return make("p", [lines.join(" ")]);
  });
}

/// A button that can be pressed once.
export function pressed(label: string, more: HTMLElement[] = []): { button: HTMLButtonElement; all: HTMLElement; done: Promise<void> } {
  const button = make("button", [label], { className: "main", type: "button" });
  const done = new Promise<void>((resolve) => button.addEventListener("click", () => { button.disabled = true; resolve(); }));
  return { button, all: make("p", [button, ...more]), done };
}

export async function text(title: string, body: string, label: string): Promise<number> {
  const begun = performance.now();
  const go = pressed(label);
  show(make("h1", [title]), ...paragraphs(body), go.all);
  await go.done;
  return (performance.now() - begun) / 1000;
}

/// Asks one scale, `before` already answered; a missing answer is asked for once, then taken as left out. `changed` gets every change.
export async function sheet(
  scale: { title: string; items: string[]; min: number; max: number }, before: (number | null)[], changed: (answers: (number | null)[]) => void,
): Promise<{ answers: (number | null)[]; seconds: number }> {
  const begun = performance.now();
  const sets = scale.items.map((item, at) => {
    const points: HTMLElement[] = [];
    for (let value = scale.min; value <= scale.max; value++) {
      const input = make("input", [], { type: "radio", name: `item${at}`, value: String(value), checked: before[at] === value });
      points.push(make("label", [input, ` ${value}`]));
    }
    return make("fieldset", [make("legend", [`${at + 1}. ${item}`]), make("div", points, { className: "points" })]);
  });
  const said = make("p", [], {});
  said.setAttribute("role", "alert");
  const button = make("button", [say("continue")], { className: "main", type: "submit" });
  const form = make("form", [...sets, said, make("p", [button])]);
  show(make("h1", [scale.title]), make("p", [say("answers_range", { min: scale.min, max: scale.max })]), form);
  const given = (): (number | null)[] => sets.map((set) => {
    const value = set.querySelector<HTMLInputElement>("input:checked")?.value;
    return value === undefined ? null : Number(value);
  });
  form.addEventListener("change", () => changed(given()));
  let asked = false;
  return new Promise((resolve) => form.addEventListener("submit", (event) => {
    event.preventDefault();
    const answers = given();
    const missing = answers.flatMap((a, at) => (a === null ? [at] : []));
    sets.forEach((set, at) => set.classList.toggle("missing", missing.includes(at)));
    if (missing.length > 0 && !asked) {
      asked = true;
      said.textContent = say("not_answered", { items: missing.map((m) => m + 1).join(", ") });
      sets[missing[0] as number]?.querySelector("input")?.focus();
      return;
    }
    button.disabled = true;
    resolve({ answers, seconds: (performance.now() - begun) / 1000 });
  }));
}
