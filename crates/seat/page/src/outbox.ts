// Lines of drives that the server has not acknowledged yet, kept in the browser too.

import { keeper, NotYet, Refused, surely, token, troubled, untroubled } from "./api";

/// Lines of a drive that are sent at once: a minute of them.
const MOST_LINES = 60;

const tooLarge = (error: unknown): boolean => error instanceof NotYet && error.status === 413;

interface Kept { id?: number; token: string; step: number; attempt: number; from: number; line: string }

function database(): Promise<IDBDatabase | null> {
  return new Promise((done) => {
    const opening = indexedDB.open("maveric-seat", 1);
    opening.onupgradeneeded = () => opening.result.createObjectStore("lines", { keyPath: "id", autoIncrement: true });
    opening.onsuccess = () => done(opening.result);
    // A browser that keeps nothing (a private window) drives all the same.
    opening.onerror = () => done(null);
  });
}

const opened = database();

async function change(work: (store: IDBObjectStore) => IDBRequest): Promise<unknown> {
  const db = await opened;
  if (!db) return undefined;
  return new Promise((done) => {
    const asked = work(db.transaction("lines", "readwrite").objectStore("lines"));
    asked.onsuccess = () => done(asked.result);
    asked.onerror = () => done(undefined);
  });
}

/// The lines of one drive on their way to the server.
export class Outbox {
  private waiting: Kept[] = [];
  private sending: Promise<void> | null = null;
  /// Lines that are sent at once; fewer after a refusal because of their size.
  private most = MOST_LINES;
  /// Steps that the server has kept.
  kept = 0;
  /// Why the server takes no more, if it does not.
  refused: Refused | null = null;

  constructor(private step: number, private attempt: number) {}

  /// Takes a line; `from` is the step after which it is no longer needed once the server has kept so many.
  async add(line: string, until: number): Promise<void> {
    const kept: Kept = { token, step: this.step, attempt: this.attempt, from: until, line };
    this.waiting.push(kept);
    kept.id = (await change((store) => store.add({ ...kept }))) as number | undefined;
  }

  /// Sends what waits; does nothing while something is on its way.
  flush(): Promise<void> {
    this.sending ??= this.once().finally(() => { this.sending = null; });
    return this.sending;
  }

  private async once(): Promise<void> {
    const now = this.waiting.slice(0, this.most);
    if (now.length === 0 || this.refused) return;
    try {
      this.kept = await keeper.lines(this.step, this.attempt, now.map((k) => k.line + "\n").join(""));
    } catch (error) {
      if (error instanceof Refused) this.refused = error; else troubled(error);
      if (tooLarge(error)) this.most = Math.max(1, Math.floor(now.length / 2));
      return;
    }
    untroubled();
    this.most = Math.min(MOST_LINES, 2 * this.most);
    const gone = now.filter((k) => k.from <= this.kept);
    this.waiting = this.waiting.filter((k) => !gone.includes(k));
    for (const k of gone) if (k.id !== undefined) await change((store) => store.delete(k.id as number));
  }

  /// Keeps nothing of what waits: its step is over, and no server takes it any more.
  async drop(): Promise<void> {
    for (const k of this.waiting) if (k.id !== undefined) await change((store) => store.delete(k.id as number));
    this.waiting = [];
  }

  get empty(): boolean { return this.waiting.length === 0; }
}

const kept = async (): Promise<Kept[]> => ((await change((store) => store.getAll())) as Kept[] | undefined) ?? [];

/// Sends what an earlier page of this person kept and could not send, and waits for the server before anything is begun anew. Gives
/// why some of it is refused for good: that stays in this browser.
export async function sendLeftovers(): Promise<string[]> {
  const groups = new Map<string, Kept[]>();
  for (const k of (await kept()).filter((k) => k.token === token)) {
    const key = `${k.step} ${k.attempt}`;
    groups.set(key, [...(groups.get(key) ?? []), k]);
  }
  const refused: string[] = [];
  for (const group of groups.values()) {
    try { await sendGroup(group); } catch (error) {
      if (!(error instanceof Refused) || error.reason === "other-tab") throw error;
      // What is left of a step that was left out, or of a part that has ended, is for nobody.
      if (error.reason === "over") { for (const k of group) await change((store) => store.delete(k.id as number)); continue; }
      refused.push(error.message);
    }
  }
  return refused;
}

/// Sends the lines of one attempt in parts, and deletes each part that was acknowledged.
async function sendGroup(group: Kept[]): Promise<void> {
  let most = MOST_LINES;
  for (let next = 0; next < group.length;) {
    const part = group.slice(next, next + most);
    const { step, attempt } = part[0] as Kept;
    const body = part.map((k) => k.line + "\n").join("");
    const acknowledged = await surely(async () => {
      try { return await keeper.lines(step, attempt, body); } catch (error) {
        if (part.length > 1 && tooLarge(error)) return null;
        throw error;
      }
    });
    if (acknowledged === null) { most = Math.max(1, Math.floor(part.length / 2)); continue; }
    for (const k of part) if (k.from <= acknowledged) await change((store) => store.delete(k.id as number));
    next += part.length;
  }
}

/// Whose lines this browser keeps.
export async function peopleOfLines(): Promise<string[]> { return (await kept()).map((k) => k.token); }

export async function deleteLines(whose: string): Promise<void> {
  for (const k of await kept()) if (k.token === whose) await change((store) => store.delete(k.id as number));
}
