// A question of one item that comes again and again during a ride, answered by a button or a digit.

import type { Than } from "./api";
import { say } from "./say";
import { make } from "./words";

/// What is asked, how far apart, and from which answer on the ride stops.
export interface Probe {
  scale: string; question: string; min: number; max: number; every_s: number; within_s: number; stop?: { rule: string; than: Than; value: number };
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
    const { question, min, max } = this.probe;
    const buttons: HTMLElement[] = [];
    for (let value = min; value <= max; value++) {
      const button = make("button", [String(value)], { type: "button" });
      button.addEventListener("click", () => { this.answer(value); button.blur(); });
      buttons.push(button);
    }
    this.place.replaceChildren(make("p", [question], { id: "question" }), make("div", buttons), make("p", [say("probe_help")]));
    this.place.hidden = false;
    this.open = true;
  }

  /// A digit answers while something is asked.
  press(code: string): void {
    const digit = /^(?:Digit|Numpad)(\d)$/.exec(code)?.[1];
    const value = Number(digit);
    if (this.open && digit !== undefined && value >= this.probe.min && value <= this.probe.max) this.answer(value);
  }

  private answer(value: number | null): void {
    this.close();
    this.note(`probe:${this.probe.scale}`, value);
    const stop = this.probe.stop;
    if (stop && holds(value, stop.than, stop.value)) this.stop(stop.rule);
  }

  close(): void {
    this.open = false;
    this.place.hidden = true;
    this.place.replaceChildren();
  }
}
