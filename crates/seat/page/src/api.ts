// What the page asks of its server.

export type Step =
  | { kind: "text"; title: string; text: string; agree: boolean }
  | { kind: "scale"; scale: string; title: string; items: string[]; min: number; max: number; moment: string }
  | { kind: "controls" }
  | { kind: "practice"; seconds: number; lane_kept_s: number; passes: number; seed: string }
  | { kind: "drive"; condition: string; seconds: number; seed: string }
  | { kind: "ride"; condition: string; number: number; seconds: number; seed: string; style: "own" | "mean"; points: number; turns: number | null }
  | { kind: "thanks"; text: string; code: string | null };

export interface Fit { embedding: number[]; covariance: number[] | null; score: number | null; readings: number }

export interface State {
  title: string; synthetic: boolean; made_up_model: boolean; mph: boolean;
  at: number; ended: string | null; steps: Step[]; fit: Fit | null; attempts: number; whole: boolean; scenario: string;
}

export const token = location.pathname.split("/").pop() ?? "";
/// This tab; the one opened last has the study.
export const tab = [...crypto.getRandomValues(new Uint8Array(16))].map((b) => b.toString(16).padStart(2, "0")).join("");

/// A reply that will not change by asking again.
export class Refused extends Error {}

async function ask(path: string, init?: RequestInit): Promise<Response> {
  const reply = await fetch(`/api/${token}${path}`, init);
  if (reply.status >= 400 && reply.status < 500) throw new Refused(await reply.text());
  if (!reply.ok) throw new Error(await reply.text());
  return reply;
}

const note = document.getElementById("note") as HTMLElement;

/// Asks until there is an answer; says meanwhile that there is none.
async function surely(path: string, init?: RequestInit): Promise<Response> {
  for (let pause = 500; ; pause = Math.min(5000, 2 * pause)) {
    try {
      const reply = await ask(path, init);
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

export const state = async (): Promise<State> => (await surely("")).json();
export const open = async (): Promise<unknown> => (await surely(`/open/${tab}`, post(null))).json();
export const model = async (): Promise<Uint8Array> => new Uint8Array(await (await surely("/model")).arrayBuffer());
export const answer = async (step: number, sheet: unknown): Promise<unknown> => (await surely(`/answer/${step}`, post(sheet))).json();
export const done = async (step: number): Promise<unknown> => (await surely(`/done/${step}`, post(null))).json();
export const keepFit = async (fit: string): Promise<unknown> => (await surely("/fit", { method: "POST", body: fit })).json();
export const leave = async (keep: boolean): Promise<unknown> => (await surely("/leave", post({ keep }))).json();
/// Sends lines of a drive once; gives the step up to which all is kept.
export const lines = async (step: number, attempt: number, body: string): Promise<number> =>
  (await ask(`/drive/${step}/${attempt}/${tab}`, { method: "POST", body })).json();
