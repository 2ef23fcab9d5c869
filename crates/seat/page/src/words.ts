// Texts, and what a page of words is made of.

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
  // Scrolled to by the focus, the first lines would stand behind the header.
  main.focus({ preventScroll: true });
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

/// A box that may be ticked, and what its tick says.
export function box(sentence: string): { body: HTMLElement; ticked: () => boolean } {
  const input = make("input", [], { type: "checkbox" });
  return { body: make("div", [make("label", [input, make("span", [sentence])])], { className: "lines" }), ticked: () => input.checked };
}

/// A text, what stands `below` it, and a button; gives the time on the page, in s.
export async function text(title: string, body: string, label: string, below: HTMLElement[] = []): Promise<number> {
  const begun = performance.now();
  const go = pressed(label);
  show(make("h1", [title]), ...paragraphs(body), ...below, go.all);
  await go.done;
  return (performance.now() - begun) / 1000;
}
