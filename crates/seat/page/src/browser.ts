// A study without a server: this browser keeps everything, and hands it over as one file at the end.

import { world } from "../built/seat";
import { token, type Between, type Keeper, type State, type Step } from "./api";
import { say } from "./say";
import { make } from "./words";

/// The study, as `maveric seat export` wrote it.
interface Study extends Omit<State, "at" | "ended" | "steps" | "fit" | "attempts" | "whole" | "withdraw" | "aborted" | "between" | "redirect"> {
  /// Whether there is a model, and where what was given is sent.
  model: boolean; post: string | null; redirect: { done: string | null; screened_out: string | null; stopped: string | null } | null;
  /// Orders of conditions, one of which is drawn.
  rows: Step[][];
}

/// How far a drive has come.
interface Drive { step: number; attempt: number; ticks: number; ended: boolean }

/// What is kept of a person beside the lines of drives.
interface Kept {
  row: number; at: number; ended: string | null; sheets: { step: number; sheet: unknown }[]; drives: Drive[]; fit: string | null; sent: boolean;
  /// Which rule of the screening held them back.
  refused?: number;
  /// Whether they stopped in a drive.
  stopped?: boolean;
  /// When they came to the step at which they are, in ms.
  since?: number;
}

/// A table of values by their names, in this browser.
class Shelf {
  private opened = new Promise<IDBDatabase>((done, failed) => {
    const opening = indexedDB.open("maveric-seat-kept", 1);
    opening.onupgradeneeded = () => opening.result.createObjectStore("kept");
    opening.onsuccess = () => done(opening.result);
    opening.onerror = () => failed(new Error(say("keeps_nothing")));
  });

  private async ask<T>(mode: IDBTransactionMode, work: (store: IDBObjectStore) => IDBRequest<T>): Promise<T> {
    const db = await this.opened;
    return new Promise((done, failed) => {
      const transaction = db.transaction("kept", mode, { durability: "strict" });
      const asked = work(transaction.objectStore("kept"));
      transaction.oncomplete = () => done(asked.result);
      transaction.onabort = () => failed(new Error(say("could_not_keep", { why: transaction.error?.message ?? "" })));
    });
  }

  get(name: string): Promise<unknown> { return this.ask("readonly", (store) => store.get(name)); }
  put(name: string, value: unknown): Promise<unknown> { return this.ask("readwrite", (store) => store.put(value, name)); }
  /// Every value whose name begins so, in the order of names.
  all(start: string): Promise<unknown[]> { return this.ask("readonly", (store) => store.getAll(IDBKeyRange.bound(start, `${start}\uffff`))); }
  clear(): Promise<unknown> { return this.ask("readwrite", (store) => store.clear()); }
}

const lineName = (step: number, attempt: number, tick: number): string =>
  `line ${String(step).padStart(4, "0")} ${String(attempt).padStart(4, "0")} ${String(tick).padStart(9, "0")}`;

/// A drive or a ride as a study names it: by its condition, and which of several.
const named = ({ condition, session, trial }: { condition: string; session?: number; trial?: number }): string =>
  (session ?? 1) === 1 && (trial ?? 1) === 1 ? condition : `${condition}:s${session ?? 1}:t${trial ?? 1}`;

/// Where the page leads back to at the end: whoever stops or leaves is paid, too.
function leadsTo(redirect: Study["redirect"], kept: Kept): string | null {
  if (!redirect || !kept.ended) return null;
  if (kept.ended === "not admitted") return redirect.screened_out;
  return kept.ended === "done" && !kept.stopped ? redirect.done : redirect.stopped;
}

/// When the next session is, by Greenwich's days, as a server would say it.
function between([least, most]: [number, number], since: number): Between {
  const day = (days: number): string => new Date(since + days * 86_400_000).toISOString().slice(0, 10);
  return { from: day(least), until: day(most), open: new Date().toISOString().slice(0, 10) >= day(least) };
}

export class Browser implements Keeper {
  private shelf = new Shelf();
  private study: Promise<Study>;

  constructor(file: string) {
    this.study = fetch(file).then((reply) => reply.json() as Promise<Study>);
  }

  private async kept(): Promise<Kept> {
    const kept = (await this.shelf.get("person")) as Kept | undefined;
    if (kept) return kept;
    const { rows } = await this.study;
    const asked = Number(new URLSearchParams(location.search).get("row") ?? Number.NaN);
    const drawn = (crypto.getRandomValues(new Uint32Array(1))[0] as number) % rows.length;
    const row = Number.isInteger(asked) && asked >= 0 && asked < rows.length ? asked : drawn;
    return { row, at: 0, ended: null, sheets: [], drives: [], fit: null, sent: false };
  }

  private turn: Promise<unknown> = Promise.resolve();
  /// One change after the other: each begins with what the one before left.
  private alone<T>(work: () => Promise<T>): Promise<T> {
    const next = this.turn.then(work, work);
    this.turn = next.catch(() => {});
    return next;
  }

  private change(change: (kept: Kept) => void): Promise<void> {
    return this.alone(async () => {
      const kept = await this.kept();
      const before = kept.at;
      change(kept);
      if (kept.at !== before) kept.since = Date.now();
      await this.shelf.put("person", kept);
    });
  }

  open(): Promise<void> { return this.change(() => {}); }

  async state(): Promise<State> {
    const [study, kept] = [await this.study, await this.kept()];
    const { rows, model: _model, post: _post, redirect, ...told } = study;
    const steps = (rows[kept.row] as Step[]).map((step): Step => {
      if (step.kind === "ride" && typeof step.style === "object") {
        const seed = world(token, `${step.condition} across`);
        if ("across" in step.style) step = { ...step, style: { across: seed } };
        else if ("lent" in step.style) step = { ...step, style: { lent: { ...step.style.lent, seed } } };
      }
      // A world that everybody meets is drawn by the study.
      if (!("seed" in step) || step.seed !== "") return step;
      return { ...step, seed: world(token, step.kind === "practice" ? "practice" : named(step)) };
    });
    const begun = kept.drives.filter((d) => d.step === kept.at);
    const fit = kept.fit === null ? null : JSON.parse(kept.fit) as State["fit"];
    const now = steps[kept.at];
    return {
      ...told, redirect: leadsTo(redirect, kept), between: now?.kind === "between" ? between(now.days, kept.since ?? Date.now()) : null, styles: null, withdraw: null, aborted: false, at: kept.at, ended: kept.ended, steps, fit,
      attempts: begun.reduce((most, d) => Math.max(most, d.attempt), 0), whole: begun.some((d) => d.ended),
    };
  }

  async model(): Promise<Uint8Array> {
    if (!(await this.study).model) return new Uint8Array();
    return new Uint8Array(await (await fetch("model.maveric")).arrayBuffer());
  }

  async ownDrive(): Promise<string> {
    const [{ rows }, kept] = [await this.study, await this.kept()];
    const step = (rows[kept.row] as Step[]).findIndex((s) => s.kind === "drive");
    const whole = kept.drives.find((d) => d.step === step && d.ended);
    if (!whole) throw new Error(say("no_style"));
    const lines = await this.shelf.all(lineName(step, whole.attempt, 0).slice(0, -9));
    return lines.map((line) => `${String(line)}\n`).join("");
  }

  async answer(step: number, sheet: unknown): Promise<void> {
    const { rows } = await this.study;
    const steps = (kept: Kept): Step[] => rows[kept.row] ?? [];
    return this.change((kept) => {
      if (!kept.sheets.some((s) => s.step === step)) kept.sheets.push({ step, sheet });
      const passed = steps(kept)[step + 1]?.kind === "aftercare";
      kept.at = Math.max(kept.at, step + (passed ? 2 : 1));
    });
  }

  judged(step: number, refused: number | null): Promise<void> {
    return this.change((kept) => {
      if (refused !== null) { kept.ended ??= "not admitted"; kept.refused = refused; } else kept.at = Math.max(kept.at, step + 1);
    });
  }

  // Static files speak one language.
  choose(): Promise<void> { return Promise.resolve(); }

  async done(step: number): Promise<void> {
    const { rows } = await this.study;
    const kept = await this.kept();
    const lines = await this.shelf.all(lineName(step, Math.max(1, ...kept.drives.filter((d) => d.step === step).map((d) => d.attempt)), 0).slice(0, -9));
    const stopped = lines.some((line) => String(line).includes(`"stopped: `));
    await this.change((kept) => {
      const steps = rows[kept.row] ?? [], aftercare = steps.findIndex((s) => s.kind === "aftercare");
      if (steps[step]?.kind === "thanks") kept.ended ??= "done";
      if (kept.at > step) return;
      // Whoever stopped drives no more; whoever did not goes past what is told then.
      kept.stopped ||= stopped;
      if (stopped && aftercare > step) kept.at = aftercare;
      else kept.at = step + (aftercare === step + 1 ? 2 : 1);
    });
  }

  keepFit(fit: string): Promise<void> { return this.change((kept) => { kept.fit = fit; }); }

  async leave(keep: boolean): Promise<void> {
    if (!keep) await this.alone(() => this.shelf.clear());
    await this.change((kept) => { kept.ended = keep ? "left" : "deleted"; });
  }

  lines(step: number, attempt: number, body: string): Promise<number> { return this.alone(() => this.take(step, attempt, body)); }

  private async take(step: number, attempt: number, body: string): Promise<number> {
    const kept = await this.kept();
    if (kept.ended) return 0;
    let drive = kept.drives.find((d) => d.step === step && d.attempt === attempt);
    for (const line of body.split("\n").filter((l) => l)) {
      const read = JSON.parse(line) as { from_tick?: number; ticks?: number; end_tick?: number };
      if (read.from_tick !== undefined) {
        if (!drive || read.from_tick !== drive.ticks) continue;
        // Names sort as pieces follow on one another: the head first, the end last.
        await this.shelf.put(lineName(step, attempt, 1 + drive.ticks), line);
        drive.ticks += read.ticks ?? 0;
      } else if (read.end_tick !== undefined) {
        if (!drive || read.end_tick !== drive.ticks) continue;
        await this.shelf.put(lineName(step, attempt, 999_999_999), line);
        drive.ended = true;
      } else if (!drive) {
        await this.shelf.put(lineName(step, attempt, 0), line);
        drive = { step, attempt, ticks: 0, ended: false };
        kept.drives.push(drive);
      }
    }
    await this.shelf.put("person", kept);
    return drive?.ticks ?? 0;
  }

  /// Everything as lines, as `maveric seat import` takes it in.
  private async file(): Promise<string> {
    const kept = await this.kept();
    const head = { maveric_seat_person: 1, token, row: kept.row };
    if (kept.refused !== undefined) return [head, { not_admitted: kept.refused, step: kept.at }].map((line) => `${JSON.stringify(line)}\n`).join("");
    const lines: unknown[] = [head, ...kept.sheets];
    for (const { step, attempt } of kept.drives) {
      const record = await this.shelf.all(lineName(step, attempt, 0).slice(0, -9));
      lines.push({ step, attempt, record: record.map((line) => `${String(line)}\n`).join("") });
    }
    if (kept.fit !== null) lines.push({ fit: JSON.parse(kept.fit) as unknown });
    lines.push({ ended: kept.ended });
    return lines.map((line) => `${JSON.stringify(line)}\n`).join("");
  }

  async handOver(): Promise<HTMLElement[]> {
    const kept = await this.kept();
    if (kept.ended === "deleted") return [];
    const { post } = await this.study;
    if (kept.ended === "not admitted" && !post) return [];
    // Who left before they gave anything has nothing to hand over.
    if (kept.ended === "left" && kept.sheets.length === 0 && kept.drives.length === 0) return [];
    const file = await this.file();
    const save = make("a", [say("save_file")], {
      href: URL.createObjectURL(new Blob([file], { type: "application/jsonl" })), download: `maveric-seat-${token.slice(0, 8)}.jsonl`, className: "button",
    });
    if (!post) return [make("p", [say("hand_over")]), make("p", [save])];
    if (!kept.sent) {
      try {
        const reply = await fetch(post, { method: "POST", body: file });
        if (!reply.ok) throw new Error(String(reply.status));
        await this.change((k) => { k.sent = true; });
      } catch {
        return [make("p", [say("not_sent")]), make("p", [save])];
      }
    }
    return kept.ended === "not admitted" ? [] : [make("p", [say("arrived")])];
  }
}
