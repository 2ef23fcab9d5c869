// A question of one item that comes again and again during a ride, answered by a button or a digit.

import type { Than } from "./api";
import { say } from "./say";
import { endsOf, heard, side, titleOf, values, wordsOf, type Item } from "./sheet";
import { make } from "./words";

/// What is asked, how far apart, and from which answer on the ride stops.
export interface Probe {
  scale: string; instruction?: string; question: Item; every_s: number; within_s: number; stop?: { rule: string; than: Than; value: number };
}

/// Whether an answer is so beside a number; an item that was left out holds no rule.
export function holds(answer: number | null, than: Than, value: number): boolean {
  if (answer === null) return false;
  switch (than) {
    case ">=": return answer >= value;
    case "<=": return answer <= value;
    case ">": return answer > value;
    case "<": return answer < value;
    case "==": return answer === value;
    case "!=": return answer !== value;
  }
}

/// Whether nobody goes on after this answer.
const stops = ({ stop }: Probe, answer: number | null): boolean => stop !== undefined && holds(answer, stop.than, stop.value);

/// Whether the digit of this answer is its key: between two words no numbers are shown.
const hasKey = (item: Item, value: number): boolean => item.pair === null && value >= 0 && value <= 9;

export class Asking {
  private asked = 0;
  private open = false;

  /// `note` writes an answer down, null where none came in time; `stop` ends the ride.
  constructor(
    private readonly probe: Probe, private readonly place: HTMLElement,
    private readonly note: (what: string, answer: number | null) => void, private readonly stop: (why: string) => void,
  ) {}

  /// Asks when it is time, and takes a question back that was not answered in time.
  tick(seconds: number): void {
    const { every_s: every, within_s: within } = this.probe;
    if (this.open && seconds >= this.asked * every + within) this.answer(null);
    if (Math.floor(seconds / every) > this.asked) { this.asked = Math.floor(seconds / every); this.ask(); }
  }

  private ask(): void {
    const { instruction, question } = this.probe;
    const all = values(question), [left, right] = endsOf(question);
    const beside = (word: string | undefined): HTMLElement[] => (word ? [side(word)] : []);
    this.place.replaceChildren(
      ...(instruction ? [make("p", [instruction])] : []),
      make("p", [titleOf(question)], { id: "question", className: question.text ? "" : "unseen" }),
      make("div", [...beside(left), ...all.map((value, at) => this.button(value, at, at === all.length - 1)), ...beside(right)]),
      ...(all.some((value) => hasKey(question, value)) ? [make("p", [say("probe_help")])] : []),
    );
    this.place.hidden = false;
    this.open = true;
  }

  /// An answer with its words. Where the highest ends the ride, its button says so as the one that stops does.
  private button(value: number, at: number, highest: boolean): HTMLElement {
    const { question } = this.probe;
    const number = question.pair ? "" : String(value), words = wordsOf(question, at);
    const stop = highest && stops(this.probe, value) ? say("unwell") : "";
    const joined = (parts: string[], by: string): string => parts.filter((part) => part).join(by);
    const button = make("button", [joined([joined([number, words === number ? "" : words], " "), stop], " · ")], { type: "button" });
    const name = heard(question, at);
    if (name) button.ariaLabel = joined([name, stop], ", ");
    button.addEventListener("click", () => { this.answer(value); button.blur(); });
    return button;
  }

  /// A digit answers while something is asked.
  press(code: string): void {
    const digit = /^(?:Digit|Numpad)(\d)$/.exec(code)?.[1];
    const value = Number(digit), { question } = this.probe;
    if (this.open && hasKey(question, value) && values(question).includes(value)) this.answer(value);
  }

  private answer(value: number | null): void {
    this.close();
    this.note(`probe:${this.probe.scale}`, value);
    if (this.probe.stop && stops(this.probe, value)) this.stop(this.probe.stop.rule);
  }

  close(): void {
    this.open = false;
    this.place.hidden = true;
    this.place.replaceChildren();
  }
}
