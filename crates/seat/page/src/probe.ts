// A question of one item that comes again and again during a ride, answered by a button or by the digits of its number.

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

/// After a digit with which a longer number begins, too, so long is waited for the next one, in ms.
const NEXT_DIGIT_MS = 800;

/// The answers that can be typed, as they are: between two words no numbers are shown.
const typable = (item: Item): string[] => (item.pair === null ? values(item).filter((value) => value >= 0).map(String) : []);

export class Asking {
  private asked = 0;
  private open = false;
  /// The digits so far, and what waits for the next one.
  private typed = "";
  private waiting: ReturnType<typeof setTimeout> | undefined;

  /// `note` writes an answer down, null where none came in time; `stop` ends the ride.
  constructor(
    private readonly probe: Probe, private readonly place: HTMLElement,
    private readonly note: (what: string, answer: number | null) => void, private readonly stop: (why: string) => void,
  ) {}

  /// Asks when it is time, and takes a question back that was not answered in time.
  tick(seconds: number): void {
    const { every_s: every, within_s: within } = this.probe;
    // What is half typed then may be the beginning of a longer number: nobody knows the answer.
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
      ...(typable(question).length > 0 ? [make("p", [say("probe_help")])] : []),
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

  /// Digits answer while something is asked: at once, or after a moment where a longer number begins with them, too (`1` of `10`), unless the
  /// last is pressed once more.
  press(code: string): void {
    const digit = /^(?:Digit|Numpad)(\d)$/.exec(code)?.[1];
    if (!this.open || digit === undefined) return;
    const numbers = typable(this.probe.question), both = this.typed + digit;
    const begins = (digits: string): boolean => numbers.some((number) => number.startsWith(digits));
    const meant = digit === this.typed && !begins(both);
    this.typed = begins(both) ? both : digit;
    const longer = numbers.some((number) => number !== this.typed && number.startsWith(this.typed));
    clearTimeout(this.waiting);
    if (longer && !meant) this.waiting = setTimeout(() => this.settle(), NEXT_DIGIT_MS); else this.settle();
  }

  /// Answers by what was typed so far, if that is a number of the item.
  private settle(): void {
    const typed = this.typed;
    this.typed = "";
    if (typable(this.probe.question).includes(typed)) this.answer(Number(typed));
  }

  private answer(value: number | null): void {
    this.close();
    this.note(`probe:${this.probe.scale}`, value);
    if (this.probe.stop && stops(this.probe, value)) this.stop(this.probe.stop.rule);
  }

  close(): void {
    this.open = false;
    this.typed = "";
    clearTimeout(this.waiting);
    this.place.hidden = true;
    this.place.replaceChildren();
  }
}
