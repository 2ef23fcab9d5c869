// One step after the other, as the study says.

import init, { PageModel } from "../built/seat";
import * as api from "./api";
import { keeper } from "./api";
import { checkBrowser, onlyTab } from "./before";
import { choose, keyName } from "./controls";
import { lookAtComputer } from "./needs";
import { offerFullScreen, sayHowFar } from "./bar";
import { deleteDraft, draft, keepDraft } from "./drafts";
import { run, type Wanted } from "./drive";
import { deleteForgotten } from "./forgotten";
import { askWhetherToLeave, takingBack } from "./leave";
import { sendLeftovers } from "./outbox";
import { holds, type Probe } from "./probe";
import { duration, say, sayWhatStands } from "./say";
import { sheet, titleOf } from "./sheet";
import { styles } from "./styles";
import { box, make, paragraphs, pressed, show, text } from "./words";

const leaveButton = document.getElementById("leave") as HTMLButtonElement;
let model: PageModel | null = null;

async function theModel(): Promise<PageModel | null> {
  if (!model) {
    const bytes = await keeper.model();
    if (bytes.length > 0) model = new PageModel(bytes);
  }
  return model;
}

leaveButton.addEventListener("click", askWhetherToLeave);

async function drives(state: api.State, step: api.Step & { kind: "practice" | "drive" | "ride" }): Promise<void> {
  // It had ended, and only the word of it was lost.
  if (state.whole) { await keeper.done(state.at); return; }
  const go = pressed(say(state.attempts > 0 ? "begin_again" : "begin"));
  const again = state.attempts > 0 ? [make("p", [say("cut_short")])] : [];
  const [title, body, hint] = told(state, step);
  const ready = theModel();
  show(make("h1", [title]), ...again, ...paragraphs(body), go.all);
  await go.done;
  const learned = await ready;
  const wanted: Wanted = {
    state, step: state.at, attempt: state.attempts + 1, ride: null, shown: null, seconds: step.seconds, seed: step.seed, hint, probe: step.probe ?? null,
  };
  let passed = false;
  const practised = document.getElementById("practised") as HTMLElement;
  if (step.kind === "practice") {
    wanted.enough = (seen) => {
      passed = seen.keptS >= step.lane_kept_s && seen.passes >= step.passes;
      const parts = { kept: Math.floor(Math.min(seen.keptS, step.lane_kept_s)), wanted: step.lane_kept_s, passes: Math.min(seen.passes, step.passes), of: step.passes };
      practised.textContent = say(step.passes > 0 ? "practised_pass" : "practised_keep", parts);
      return passed;
    };
  }
  if (step.kind === "ride") {
    if (step.style === "replay") wanted.shown = await keeper.ownDrive();
  }
  if (step.kind === "ride" && step.style !== "replay") {
    if (!learned) throw new Error(say("no_model"));
    const fitted = state.fit && Float64Array.from(state.fit.embedding);
    const theirs = step.style === "own" || (typeof step.style === "object" && !("given" in step.style));
    if (theirs && !fitted) throw new Error(say("no_style"));
    const beyond = (theirs && state.fit?.beyond) || null;
    wanted.ride = { model: learned, own: fitted ?? new Float64Array(), style: JSON.stringify(step.style), beyond, points: step.points, turns: step.turns };
  }
  // All rides are in the style of the first session's drive.
  const { fit, crashed } = await run(wanted, step.kind === "drive" && (step.session ?? 1) === 1 ? learned : null);
  practised.textContent = "";
  // What is practised is practised again.
  if (crashed && step.kind === "practice") return;
  if (fit) await keeper.keepFit(fit);
  await keeper.done(state.at);
  const ended: [string, string] = crashed ? ["crash_title", "crash_help"] : passed ? ["practice_passed", "practice_passed_help"] : ["practice_over", "practice_over_help"];
  if (!crashed && step.kind !== "practice") return;
  // Whoever stopped is told something else.
  const now = await keeper.state();
  if (!now.ended && now.steps[now.at]?.kind !== "aftercare") {
    sayHowFar(now);
    await text(say(ended[0]), say(ended[1]), say("continue"));
  }
}

/// A rest: the button that goes on can be pressed once it was long enough.
async function rests(at: number, leastS: number): Promise<void> {
  const begun = performance.now();
  const rested = (): number => (performance.now() - begun) / 1000;
  const go = pressed(say("continue")), left = make("p", [], { role: "status" });
  const count = (): void => {
    const seconds = Math.ceil(leastS - rested());
    go.button.disabled = seconds > 0;
    left.textContent = seconds > 0 ? say("break_left", { time: duration(seconds) }) : "";
  };
  show(make("h1", [say("break_title")]), ...paragraphs(say("break_help", { time: duration(leastS) })), left, go.all);
  count();
  const ticking = setInterval(count, 1000);
  await go.done;
  clearInterval(ticking);
  await keeper.answer(at, { seconds: rested() });
}

function told(state: api.State, step: api.Step & { kind: "practice" | "drive" | "ride" }): [string, string, string] {
  const time = duration(step.seconds);
  if (step.kind === "practice") {
    return [say("practice"), say(step.passes > 0 ? "practice_pass" : "practice_keep", { time }), say("practice")];
  }
  if (step.kind === "drive") {
    return [say("drive"), say("drive_help", { time }), say("drive_hint")];
  }
  const more = [...(step.turns ? ["ride_free"] : []), ...(state.made_up_model ? ["ride_made_up"] : [])];
  return [say("ride", { number: step.number }), [say("ride_help", { time, key: keyName("U") }), ...more.map((name) => say(name))].join("\n\n"), ""];
}

/// Judges here who takes part: no answer leaves this page or is kept in it.
async function screens(at: number, step: api.Step & { kind: "screen" }): Promise<void> {
  const begun = performance.now();
  const given: (number | null)[][] = [];
  for (const asked of step.sheets) given.push((await sheet(asked)).answers);
  const broken = step.rules.findIndex((rule) => !holds(given[rule.sheet]?.[rule.item] ?? null, rule.than, rule.value));
  await keeper.judged(at, broken < 0 ? null : broken, (performance.now() - begun) / 1000);
}

/// Asks for a language, each by its own name; the page comes anew in it.
async function chooseLanguage(at: number, languages: string[]): Promise<void> {
  const named = (language: string): string => new Intl.DisplayNames([language], { type: "language" }).of(language) ?? language;
  const chosen = await new Promise<string>((done) => {
    const buttons = languages.map((language) => {
      const button = make("button", [named(language)], { className: "main", type: "button", lang: language });
      button.addEventListener("click", () => done(language));
      return button;
    });
    show(make("h1", [document.title]), make("p", buttons.flatMap((button) => [button, " "])));
  });
  await keeper.choose(at, chosen);
  location.reload();
}

/// Cares for somebody who stopped: asks once more how they feel after a while, as a questionnaire, unless they go on before.
async function caresFor(at: number, body: string, again: Probe): Promise<void> {
  const begun = performance.now(), title = say("aftercare_title");
  const go = pressed(say("continue"));
  show(make("h1", [title]), ...paragraphs(body), make("p", [say("felt_again", { time: duration(again.every_s) })]), go.all);
  const asked = make("p", [], { role: "status", className: "unseen" });
  document.getElementById("main")?.before(asked);
  const waited = new Promise<boolean>((done) => setTimeout(() => done(true), 1000 * again.every_s));
  const stayed = await Promise.race([waited, go.done.then(() => false)]);
  const instruction = [body, again.instruction ?? ""].join("\n\n");
  // Somebody who does not look at the page hears that it asks now.
  asked.textContent = stayed ? titleOf(again.question) : "";
  const answers = stayed ? (await sheet({ title, instruction, items: [again.question] })).answers : [null];
  asked.remove();
  if (answers[0] === null) await keeper.done(at); else await keeper.answer(at, { answers, seconds: (performance.now() - begun) / 1000 });
}

/// Judges here whether the computer has what the study needs.
async function looksAtComputer(state: api.State, step: api.Step & { kind: "computer" }): Promise<void> {
  const begun = performance.now();
  const missing = await lookAtComputer(state, step.needs);
  await keeper.judged(state.at, missing, (performance.now() - begun) / 1000);
}

/// With what everybody drives, where the study says it.
function deviceOf(steps: api.Step[]): "keyboard" | "wheel" | null {
  const needs = steps.flatMap((step) => (step.kind === "computer" ? step.needs : []));
  return needs.map((need) => (need.what === "device" ? need.device : null)).find((device) => device !== null) ?? null;
}

/// What somebody reads who has not taken part: a heading, and why.
const WITHOUT: Record<string, [string, string]> = { "not admitted": ["thank_you", "not_admitted"], "never came": ["over", "given_away"] };

async function once(state: api.State): Promise<boolean> {
  const step = state.steps[state.at];
  sayHowFar(state);
  if (state.ended || !step) {
    leaveButton.hidden = true;
    const through = state.ended === "done" || !step;
    const [title, told] = WITHOUT[state.ended ?? ""] ?? [through ? "thank_you" : "have_left", null];
    const why = state.ended === "not admitted" && step?.kind === "computer" ? "other_computer" : told;
    show(make("h1", [say(title)]), ...(why ? [make("p", [say(why)])] : []),
      ...code(state), ...(state.styles ? styles(state.styles) : []),
      ...(state.redirect ? [make("p", [make("a", [say("to_platform")], { href: state.redirect, className: "button" })])] : []),
      make("p", [say(state.ended === "deleted" ? "was_deleted" : "close_page")]), ...takingBack(state));
    return false;
  }
  switch (step.kind) {
    case "language": await chooseLanguage(state.at, step.languages); return false;
    case "computer": await looksAtComputer(state, step); break;
    case "screen": await screens(state.at, step); break;
    case "text": {
      const lends = step.lend === undefined ? null : box(step.lend);
      const seconds = await text(step.title, step.text, say(step.agree ? "agree" : "continue"), lends ? [lends.body] : []);
      const answer = { agreed: true, seconds, ...(lends ? { style_lent: lends.ticked() } : {}) };
      if (step.agree) await keeper.answer(state.at, answer); else await keeper.done(state.at);
      break;
    }
    case "scale":
      await keeper.answer(state.at, await sheet(step, draft(state.at), (now) => keepDraft(state.at, now)));
      deleteDraft(state.at);
      break;
    case "break": await rests(state.at, step.at_least_s); break;
    case "controls": await choose(deviceOf(state.steps)); await keeper.done(state.at); break;
    case "practice": case "drive": case "ride": await drives(state, step); break;
    case "between": return comesAgain(state, step);
    case "elsewhere": {
      const seconds = await text(say("ride", { number: step.number }), say("elsewhere_help"), say("elsewhere_over"));
      await keeper.answer(state.at, { seconds });
      break;
    }
    case "aftercare":
      if (!state.aborted && step.again) { await caresFor(state.at, step.text, step.again); break; }
      await (state.aborted ? text(say("aborted_title"), say("aborted"), say("continue")) : text(say("aftercare_title"), step.text, say("continue")));
      await keeper.done(state.at);
      break;
    case "thanks":
      await keeper.done(state.at);
      break;
  }
  return true;
}

/// Whether the next session goes on now; says when it does where it does not.
async function comesAgain(state: api.State, { session }: api.Step & { kind: "between" }): Promise<boolean> {
  const of = 1 + state.steps.filter((step) => step.kind === "between").length;
  if (!state.between?.open) {
    show(make("h1", [say("see_you")]), make("p", [say("see_you_help", { before: session - 1, of, from: state.between?.from ?? "", until: state.between?.until ?? "" })]));
    return false;
  }
  await text(say("welcome_back"), say("welcome_back_help", { session, of }), say("continue"));
  await keeper.done(state.at);
  return true;
}

function code(state: api.State): HTMLElement[] {
  const last = state.steps.at(-1);
  if (state.ended !== "done" || last?.kind !== "thanks") return [];
  const given = last.code ? [make("p", [say("your_code"), " ", make("strong", [last.code])])] : [];
  return [...paragraphs(last.text), ...given];
}

/// The parts of earlier drives that the seat refuses for good, and why.
function leftOver(refused: string[]): void {
  if (refused.length === 0) return;
  const why = make("p", [say("refused_before", { why: refused.join("; ") })]);
  why.setAttribute("role", "alert");
  document.getElementById("main")?.before(why);
}

async function main(): Promise<void> {
  sayWhatStands();
  offerFullScreen();
  await onlyTab();
  await Promise.all([init({ module_or_path: new URL("seat.wasm", import.meta.url) }), keeper.open()]);
  const first = await keeper.state();
  document.title = first.title;
  (document.getElementById("title") as HTMLElement).textContent = first.title;
  await deleteForgotten(first);
  leftOver(await sendLeftovers());
  await checkBrowser(first);
  for (;;) {
    const state = await keeper.state();
    try {
      if (!(await once(state))) return;
    } catch (error) {
      // Left or ended meanwhile, elsewhere: the state says how.
      if (!(error instanceof api.Refused && error.reason === "over")) throw error;
    }
  }
}

main().catch((error: unknown) => {
  const why = error instanceof Error ? error.message : String(error);
  const again = pressed(say("try_again"));
  void again.done.then(() => location.reload());
  // Nothing is read behind the road.
  (document.getElementById("drive") as HTMLElement).hidden = true;
  show(make("h1", [say("cannot_go_on")]), make("p", [why]), again.all);
});
