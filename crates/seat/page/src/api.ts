// What the page asks of its server.

export type Step =
  | { kind: "text"; title: string; text: string; agree: boolean }
  | { kind: "scale"; scale: string; title: string; items: string[]; min: number; max: number; moment: string }
  | { kind: "controls" }
  | { kind: "practice"; seconds: number; lane_kept_s: number; passes: number; seed: string }
  | { kind: "drive"; condition: string; seconds: number; seed: string }
  | { kind: "ride"; condition: string; number: number; seconds: number; seed: string; style: "own" | "mean"; points: number; stretch: number; turns: number | null }
  | { kind: "thanks"; text: string; code: string | null };

export interface Fit { embedding: number[]; covariance: number[] | null; score: number | null; readings: number }

/// Where the eyes are (m above the road), how much they see upwards and downwards (degrees), on one screen or three, the outer ones
/// turned by so much.
export interface ViewSettings { eye_m: number; field_deg: number; screens: number; side_deg: number }

export interface State {
  title: string; synthetic: boolean; made_up_model: boolean; mph: boolean;
  at: number; ended: string | null; steps: Step[]; fit: Fit | null; attempts: number; whole: boolean; scenario: string; view: ViewSettings;
}

export const token = location.pathname.split("/").pop() ?? "";
/// This tab; the one opened last has the study.
export const tab = [...crypto.getRandomValues(new Uint8Array(16))].map((b) => b.toString(16).padStart(2, "0")).join("");

/// A reply that will not change by asking again.
export class Refused extends Error {
  constructor(readonly status: number, message: string) { super(message); }
}

async function ask(path: string, init?: RequestInit): Promise<Response> {
  const reply = await fetch(`/api/${token}${path}`, init);
  if (reply.status >= 400 && reply.status < 500) throw new Refused(reply.status, await reply.text());
  if (!reply.ok) throw new Error(await reply.text());
  return reply;
}

const note = document.getElementById("note") as HTMLElement;

/// Asks until there is an answer; says meanwhile that there is none.
export async function surely<T>(asks: () => Promise<T>): Promise<T> {
  for (let pause = 500; ; pause = Math.min(5000, 2 * pause)) {
    try {
      const reply = await asks();
      note.textContent = "";
      return reply;
    } catch (error) {
      if (error instanceof Refused) throw error;
      note.textContent = "No connection; trying again. Nothing is lost.";
      await new Promise((done) => setTimeout(done, pause));
    }
  }
}

const post = (body: unknown): RequestInit => ({ method: "POST", body: JSON.stringify(body) });

const json = async (path: string, init?: RequestInit): Promise<unknown> => surely(async () => (await ask(path, init)).json());

export const state = async (): Promise<State> => (await json("")) as State;
export const open = (): Promise<unknown> => json(`/open/${tab}`, post(null));
export const model = (): Promise<Uint8Array> => surely(async () => new Uint8Array(await (await ask("/model")).arrayBuffer()));
export const answer = (step: number, sheet: unknown): Promise<unknown> => json(`/answer/${step}`, post(sheet));
export const done = (step: number): Promise<unknown> => json(`/done/${step}`, post(null));
export const keepFit = (fit: string): Promise<unknown> => json("/fit", { method: "POST", body: fit });
export const leave = (keep: boolean): Promise<unknown> => json("/leave", post({ keep }));
/// Sends lines of a drive once; gives the step up to which all is kept.
export const lines = async (step: number, attempt: number, body: string): Promise<number> =>
  (await ask(`/drive/${step}/${attempt}/${tab}`, { method: "POST", body })).json();
