// Questionnaires, each item drawn as it was published; nothing is answered beforehand.

import { say } from "./say";
import { make, paragraphs, show } from "./words";

/// An item: its answers from `min` to `max` by `step`, and the words of all of them, of the ends, or of none.
export interface Item {
  kind: "likert" | "bipolar" | "slider" | "ladder" | "choice" | "number" | "text";
  min: number; max: number; step: number; optional: boolean;
  text: string; pair: [string, string] | null; anchors: string[];
}

/// What is asked on one page.
export interface Asked { title: string | null; instruction: string | null; items: Item[] }

/// The answer to an item: a number, words, or none.
export type Given = number | string | null;

/// What was answered of a sheet so far, and for how long it was open, in s.
export interface Draft { given: Given[]; seconds: number }

const NOTHING: Draft = { given: [], seconds: 0 };

/// What stands in an item's place, and what was answered there; `wrong` is a sentence on what is no answer.
interface Field { body: HTMLElement; given: () => Given; wrong?: () => string | null }

/// Most characters of a text.
const LONGEST = 4000;
/// A slider with more steps has no marks.
const MOST_MARKS = 41;
/// As many boxes stand in one row, also on a phone, so that the words of both ends stand under theirs.
const MOST_IN_A_ROW = 21;
/// A sheet that is open is kept so often, in ms.
const KEPT_EVERY_MS = 1000;

/// Every answer of an item, from the lowest.
export const values = (item: Item): number[] => Array.from({ length: (item.max - item.min) / item.step + 1 }, (_, i) => item.min + i * item.step);

/// Whether each answer of an item has words of its own.
const worded = (item: Item): boolean => item.anchors.length === values(item).length;

/// The words of the answer at this place; none where it has none of its own.
export const wordsOf = (item: Item, at: number): string => (worded(item) ? item.anchors[at] ?? "" : "");

/// The words of both ends, where the answers between them have none.
export const endsOf = (item: Item): string[] => item.pair ?? (worded(item) ? [] : item.anchors);

/// What an item is called: its text, or the pair that says it.
export const titleOf = (item: Item): string => item.text || (item.pair?.join(" – ") ?? "");

/// What somebody hears of the answer at this place where not all of it stands in its box: a number with the word of its end, or the
/// place between two words.
export function heard(item: Item, at: number): string | undefined {
  const all = values(item);
  const end = at === 0 ? endsOf(item)[0] : at === all.length - 1 ? endsOf(item)[1] : undefined;
  if (item.pair) return end ?? `${at + 1}/${all.length}`;
  return end ? `${all[at]}, ${end}` : undefined;
}

/// A button of a group, of which one can be chosen; the words beside it name it, or `label` does.
function radio(name: string, value: number, before: Given, words: string, label?: string): HTMLElement {
  const input = make("input", [], { type: "radio", name, value: String(value), checked: before === value });
  if (label) input.ariaLabel = label;
  return make("label", [input, make("span", [words])]);
}

function radios(body: HTMLElement): Field {
  const given = (): Given => {
    const chosen = body.querySelector<HTMLInputElement>("input:checked");
    return chosen ? Number(chosen.value) : null;
  };
  return { body, given };
}

/// Boxes in a row, with their words under them.
function likert(item: Item, name: string, before: Given): Field {
  const boxes = values(item).map((value, at) => radio(name, value, before, wordsOf(item, at) || String(value), heard(item, at)));
  const look = worded(item) ? "points worded" : boxes.length > MOST_IN_A_ROW ? "points many" : "points";
  const points = make("div", boxes, { className: look });
  const ends = endsOf(item);
  return radios(make("div", [points, ...(ends.length > 0 ? [under(ends)] : [])], { className: "field" }));
}

/// Words under a row, from one end to the other. Who listens hears them with the answers.
function under(anchors: string[]): HTMLElement {
  const ends = make("div", anchors.map((word) => make("span", [word])), { className: "ends" });
  ends.ariaHidden = "true";
  return ends;
}

/// The word of an end beside a row. Who listens hears it with the answers.
export function side(word: string): HTMLElement {
  const shown = make("span", [word]);
  shown.ariaHidden = "true";
  return shown;
}

/// Boxes between two words.
function bipolar(item: Item, name: string, before: Given): Field {
  const [left, right] = item.pair ?? ["", ""];
  const boxes = values(item).map((value, at) => radio(name, value, before, "", heard(item, at)));
  return radios(make("div", [side(left), make("div", boxes, { className: "boxes" }), side(right)], { className: "field between" }));
}

/// A line that has no answer until it is touched, by pointer or by key.
function slider(item: Item, _: string, before: Given): Field {
  const middle = item.min + item.step * Math.round((item.max - item.min) / item.step / 2);
  let touched = typeof before === "number";
  const input = make("input", [], { type: "range", min: String(item.min), max: String(item.max), step: String(item.step) });
  input.value = String(touched ? before : middle);
  const told = (): void => {
    input.classList.toggle("untouched", !touched);
    const [low, high] = item.anchors.length === 2 ? item.anchors : [];
    const place = values(item).indexOf(Number(input.value));
    const word = item.anchors.length > 2 ? item.anchors[place] : undefined;
    input.ariaValueText = touched ? word ?? input.value : say("no_answer_yet");
    input.ariaLabel = [item.text, low && high ? `${low} – ${high}` : ""].filter((part) => part).join(": ");
  };
  const touch = (): void => {
    if (touched) return;
    touched = true;
    told();
    input.dispatchEvent(new Event("change", { bubbles: true }));
  };
  input.addEventListener("input", () => { touched = true; told(); });
  input.addEventListener("pointerup", touch);
  input.addEventListener("keydown", (event) => { if (event.key === " " || event.key === "Enter") { event.preventDefault(); touch(); } });
  told();
  const count = values(item).length;
  const marks = count <= MOST_MARKS ? [make("div", Array.from({ length: count }, () => make("i")), { className: "marks" })] : [];
  const words = item.anchors.length > 0 ? [under(item.anchors)] : [];
  return { body: make("div", [input, ...marks, ...words], { className: "field line" }), given: () => (touched ? Number(input.value) : null) };
}

/// An answer in words a line.
function lines(item: Item, name: string, before: Given): Field {
  const boxes = values(item).map((value, at) => radio(name, value, before, wordsOf(item, at) || String(value)));
  return radios(make("div", boxes, { className: "field lines" }));
}

function number(item: Item, _: string, before: Given): Field {
  const input = make("input", [], { type: "number", min: String(item.min), max: String(item.max), step: "1" });
  input.inputMode = "numeric";
  input.ariaLabel = item.text;
  if (typeof before === "number") input.value = String(before);
  const range = { min: item.min, max: item.max };
  const body = make("div", [input, make("span", [say("number_range", range)], { className: "hint" })], { className: "field" });
  const given = (): Given => (input.value === "" || wrong() !== null ? null : Number(input.value));
  const wrong = (): string | null => {
    const value = Number(input.value);
    const fits = input.value === "" ? !input.validity.badInput : Number.isInteger(value) && value >= item.min && value <= item.max;
    return fits ? null : say("number_range", range);
  };
  return { body, given, wrong };
}

function words(item: Item, _: string, before: Given): Field {
  const area = make("textarea", [], { rows: 4, maxLength: LONGEST, value: typeof before === "string" ? before : "" });
  area.ariaLabel = item.text;
  return { body: make("div", [area], { className: "field" }), given: () => area.value.trim() || null };
}

const KINDS = { likert, bipolar, slider, ladder: lines, choice: lines, number, text: words };

/// Asks one scale, which goes on from `before`; a missing answer is asked for once, then taken as left out. `keep` gets every change, and
/// now and then the time.
export async function sheet(
  scale: Asked, before: Draft = NOTHING, keep: (draft: Draft) => void = () => {},
): Promise<{ answers: (number | null)[]; texts: Record<string, string>; seconds: number }> {
  const begun = performance.now();
  // A sheet that was left open for eleven days can still be sent.
  const seconds = (): number => Math.min(before.seconds + (performance.now() - begun) / 1000, 999_999);
  const { items } = scale;
  const fields = items.map((item, at) => KINDS[item.kind](item, `item${at}`, before.given[at] ?? null));
  const sets = items.map((item, at) => {
    const numbered = items.length > 1 ? `${at + 1}. ` : "";
    const { body } = fields[at] as Field;
    if (item.text) return make("fieldset", [make("legend", [numbered + item.text]), body]);
    // Of a pair the words stand beside the boxes; the group is named by them all the same.
    const place = make("span", [numbered]);
    place.ariaHidden = "true";
    const name = make("legend", [numbered + titleOf(item)], { className: "unseen" });
    return make("fieldset", [name, make("div", [place, body], { className: "numbered" })]);
  });
  const said = make("p", [], {});
  said.setAttribute("role", "alert");
  const button = make("button", [say("continue")], { className: "main", type: "submit" });
  const form = make("form", [...sets, said, make("p", [button])], { noValidate: true });
  const heading = make("h1", [scale.title ?? say("questions")], { className: scale.title ? "" : "unseen" });
  const bare = items.find((item) => item.kind === "likert" && item.anchors.length === 0);
  const range = bare ? [make("p", [say("answers_range", { min: bare.min, max: bare.max })])] : [];
  show(heading, ...paragraphs(scale.instruction ?? ""), ...range, form);
  const given = (): Given[] => fields.map((field) => field.given());
  const keepNow = (): void => keep({ given: given(), seconds: seconds() });
  for (const kind of ["change", "input"]) form.addEventListener(kind, keepNow);
  const keeping = setInterval(keepNow, KEPT_EVERY_MS);
  let asked = false;
  return new Promise((resolve) => form.addEventListener("submit", (event) => {
    event.preventDefault();
    const all = given();
    const stop = (marked: number[], sentence: string): void => {
      sets.forEach((set, at) => set.classList.toggle("missing", marked.includes(at)));
      said.textContent = sentence;
      const first = sets[marked[0] as number];
      first?.querySelector<HTMLElement>("input, textarea")?.focus({ preventScroll: true });
      first?.scrollIntoView({ block: "nearest" });
    };
    const wrong = fields.findIndex((field) => field.wrong?.());
    if (wrong >= 0) { stop([wrong], say("no_answer", { item: wrong + 1, range: fields[wrong]?.wrong?.() ?? "" })); return; }
    const missing = all.flatMap((answer, at) => (answer === null && !items[at]?.optional ? [at] : []));
    if (missing.length > 0 && !asked) {
      asked = true;
      stop(missing, say("not_answered", { items: missing.map((m) => m + 1).join(", ") }));
      return;
    }
    button.disabled = true;
    clearInterval(keeping);
    const texts = Object.fromEntries(all.flatMap((answer, at) => (typeof answer === "string" ? [[String(at + 1), answer]] : [])));
    resolve({ answers: all.map((answer) => (typeof answer === "number" ? answer : null)), texts, seconds: seconds() });
  }));
}
