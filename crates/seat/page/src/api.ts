// What the page asks of its server.

import type { Probe } from "./probe";
import { say } from "./say";
import type { Asked } from "./sheet";

/// How an answer is held against a number.
export type Than = ">=" | "<=" | ">" | "<" | "==" | "!=";

/// A rule on one answer of a screening: which sheet, which item of it.
export interface Judged { rule: string; sheet: number; item: number; than: Than; value: number }

export type Sheet = Step & { kind: "scale" };

/// One thing that a study needs of a computer.
export type Need =
  | { what: "webgl" }
  | { what: "pictures_per_second" | "width_px" | "height_px"; least: number }
  | { what: "device"; device: "keyboard" | "wheel" };

export type Step =
  | { kind: "language"; languages: string[] }
  | { kind: "computer"; needs: Need[] }
  | { kind: "screen"; sheets: Sheet[]; rules: Judged[] }
  | { kind: "text"; title: string; text: string; agree: boolean; lend?: string }
  | { kind: "scale"; scale: string; moment: string } & Asked
  | { kind: "break"; at_least_s: number }
  | { kind: "controls" }
  | { kind: "practice"; seconds: number; lane_kept_s: number; passes: number; seed: string; probe?: Probe }
  | { kind: "drive"; condition: string; session?: number; seconds: number; seed: string; probe?: Probe }
  | { kind: "ride"; condition: string; session?: number; trial?: number; number: number; seconds: number; seed: string; style: RideStyle; points: number; turns: number | null; probe?: Probe }
  | { kind: "elsewhere"; condition: string; number: number }
  | { kind: "between"; session: number; days: [number, number] }
  | { kind: "aftercare"; text: string; again?: Probe }
  | { kind: "thanks"; text: string; code: string | null };

/// Whose style drives: the person's own, the average driver's, the own one moved across the dial as a seed says, somebody else's of whom
/// the model learned, whom a seed draws, this one, or none: the own drive is shown again.
export type RideStyle = "own" | "mean" | "replay" | { across: string } | { lent: { apart_sd: number[]; seed: string; withheld?: string[] } } | { given: number[] };

/// `beyond`: why the drive is beyond what the model has learned from, such as `scale` or `style:pass`; left out where it is not.
export interface Fit { embedding: number[]; covariance: number[] | null; score: number | null; readings: number; beyond?: string }

/// Where the eyes are (m above the road), how much they see upwards and downwards (degrees), on one screen or three, the outer ones
/// turned by so much.
export interface ViewSettings { eye_m: number; field_deg: number; screens: number; side_deg: number }

/// One's own style beside those of the others (lowest first), in points that the model reads; `own` is null of a drive beyond what it
/// has learned from.
export interface Styles { own: number | null; others: number[]; sportier_up: boolean }

/// Until when (`2026-12-31`; null: always) somebody can take back what they gave, and whether it is so today.
export interface Withdrawal { until: string | null; open: boolean }

/// From which day on the next session is, until when it should be, and whether that day has come.
export interface Between { from: string; until: string; open: boolean }

export interface State {
  title: string; synthetic: boolean; made_up_model: boolean; mph: boolean;
  at: number; ended: string | null; steps: Step[]; fit: Fit | null; attempts: number; whole: boolean; aborted: boolean; scenario: string; crash: "ends" | "felt"; view: ViewSettings; styles: Styles | null;
  /// Where the platform is that pays; null before the end, and where there is none.
  redirect: string | null;
  /// Null but between two sessions.
  between: Between | null;
  withdraw: Withdrawal;
}

const random = (): string => [...crypto.getRandomValues(new Uint8Array(16))].map((b) => b.toString(16).padStart(2, "0")).join("");

export const token = location.pathname.split("/").pop() ?? "";
/// This tab; the one opened last has the study.
export const tab = random();

/// The seat's own word on a reply that stays. A reply without it (a proxy's 413, 429 or 502; a full disk) may pass.
const LASTING = "maveric-refused";

/// How the refusals of the seat are said; every other is said as it came.
const REFUSALS: Record<string, string> = { "no-such-person": "no_link", over: "over", "other-tab": "open_elsewhere", "too-late": "too_late" };

/// A reply that will not change by asking again.
export class Refused extends Error {
  constructor(readonly reason: string, message: string) { super(message); }
}

/// A reply that may change by asking again.
export class NotYet extends Error {
  constructor(readonly status: number, message: string) { super(message); }
}

async function ask(path: string, init?: RequestInit): Promise<Response> {
  const reply = await fetch(`/api/${token}${path}`, init);
  const reason = reply.headers.get(LASTING);
  if (reason !== null) throw new Refused(reason, say(REFUSALS[reason] ?? "not_taken", { why: await reply.text() }));
  if (!reply.ok) throw new NotYet(reply.status, await reply.text());
  return reply;
}

const note = document.getElementById("note") as HTMLElement;

/// Says beside the title why something has not arrived yet.
export function troubled(error: unknown): void {
  note.textContent = error instanceof NotYet ? say("not_yet", { status: error.status }) : say("no_connection");
}

export function untroubled(): void { note.textContent = ""; }

/// Asks until there is an answer; says meanwhile that there is none.
export async function surely<T>(asks: () => Promise<T>): Promise<T> {
  for (let pause = 500; ; pause = Math.min(5000, 2 * pause)) {
    try {
      const reply = await asks();
      untroubled();
      return reply;
    } catch (error) {
      if (error instanceof Refused) throw error;
      troubled(error);
      await new Promise((done) => setTimeout(done, pause));
    }
  }
}

const post = (body: unknown): RequestInit => ({ method: "POST", body: JSON.stringify(body) });

const json = async (path: string, init?: RequestInit): Promise<unknown> => surely(async () => (await ask(path, init)).json());

/// The server, which keeps what a person gives.
export const keeper = {
  state: async () => (await json("")) as State,
  open: () => json(`/open/${tab}`, post(null)),
  model: () => surely(async () => new Uint8Array(await (await ask("/model")).arrayBuffer())),
  /// The record of the person's own drive by hand, as lines.
  ownDrive: () => surely(async () => (await ask("/own")).text()),
  answer: (step: number, sheet: unknown) => json(`/answer/${step}`, post(sheet)),
  /// Says whether a rule of a screening holds somebody back, and which; the answers stay in the page.
  judged: (step: number, refused: number | null, seconds: number) => json(`/answer/${step}`, post({ refused, seconds })),
  /// Goes on in a language: the page is to be loaded anew.
  choose: (step: number, language: string) => json(`/language/${step}/${language}`, post(null)),
  done: (step: number) => json(`/done/${step}`, post(null)),
  keepFit: (fit: string) => json("/fit", { method: "POST", body: fit }),
  leave: (keep: boolean) => json("/leave", post({ keep })),
  /// Takes lines of a drive; gives the step up to which all is kept.
  lines: async (step: number, attempt: number, body: string): Promise<number> => (await ask(`/drive/${step}/${attempt}/${tab}`, { method: "POST", body })).json(),
};
