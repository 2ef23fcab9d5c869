// One step after the other, as the study says.

import init, { PageModel } from "../built/seat";
import * as api from "./api";
import { checkBrowser, onlyTab } from "./before";
import { choose } from "./controls";
import { keeper } from "./keeper";
import { deleteDraft, draft, keepDraft } from "./drafts";
import { run, type Wanted } from "./drive";
import { deleteForgotten } from "./forgotten";
import { askWhetherToLeave, takingBack } from "./leave";
import { sendLeftovers } from "./outbox";
import { styles } from "./styles";
import { make, paragraphs, pressed, sheet, show, text } from "./words";

/// A duration in words that is not off by more than a twentieth.
const minutes = (seconds: number): string => {
  const whole = Math.round(seconds / 60);
  if (Math.abs(60 * whole - seconds) > 0.05 * seconds) return `${Math.round(seconds)} seconds`;
  return whole === 1 ? "one minute" : `${whole} minutes`;
};
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
  const go = pressed(state.attempts > 0 ? "Begin again" : "Begin");
  const again = state.attempts > 0 ? [make("p", ["This part was cut short and begins again."])] : [];
  const [title, body, hint] = told(state, step);
  const ready = theModel();
  show(make("h1", [title]), ...again, ...paragraphs(body), go.all);
  await go.done;
  const learned = await ready;
  const wanted: Wanted = {
    state, step: state.at, attempt: state.attempts + 1, ride: null, seconds: step.seconds, seed: step.seed, hint,
  };
  if (step.kind === "practice") {
    wanted.enough = (seen) => seen.keptS >= step.lane_kept_s && seen.passes >= step.passes;
  }
  if (step.kind === "ride") {
    if (!learned) throw new Error("there is no model to ride with");
    const fitted = state.fit && Float64Array.from(state.fit.embedding);
    const theirs = step.style === "own" || (typeof step.style === "object" && "across" in step.style);
    if (theirs && !fitted) throw new Error("no style was learned of the drive by hand");
    const beyond = (theirs && state.fit?.beyond) || null;
    wanted.ride = { model: learned, own: fitted ?? new Float64Array(), style: JSON.stringify(step.style), beyond, points: step.points, stretch: step.stretch, turns: step.turns };
  }
  const fit = await run(wanted, step.kind === "drive" ? learned : null);
  if (fit) await keeper.keepFit(fit);
  await keeper.done(state.at);
}

function told(state: api.State, step: api.Step & { kind: "practice" | "drive" | "ride" }): [string, string, string] {
  if (step.kind === "practice") {
    return ["Practice", `Get to know the car: keep to your lane${step.passes > 0 ? ", and pass a slower car" : ""}. It takes at most ${minutes(step.seconds)}.`, "Practice"];
  }
  if (step.kind === "drive") {
    return ["Your drive", `Drive for ${minutes(step.seconds)} as you would on such a road, whoever is ahead of you.`, "Drive as you would"];
  }
  const made = state.made_up_model ? "\n\nThe model that drives learned from made-up people." : "";
  const free = step.turns ? "\n\nDuring this ride you may make the car calmer or sportier, as often as you like." : "";
  return [`Ride ${step.number}`, `The car drives for ${minutes(step.seconds)}. Watch the road. Press U whenever it makes you uncomfortable.${free}${made}`, ""];
}

async function once(state: api.State): Promise<boolean> {
  const step = state.steps[state.at];
  if (state.ended || !step) {
    leaveButton.hidden = true;
    show(make("h1", [state.ended === "done" || !step ? "Thank you" : "You have left the study"]),
      ...code(state), ...(state.styles ? styles(state.styles) : []), ...await keeper.handOver(),
      make("p", [state.ended === "deleted" ? "What you gave was deleted." : "You can close this page."]), ...takingBack(state));
    return false;
  }
  switch (step.kind) {
    case "text": {
      const seconds = await text(step.title, step.text, step.agree ? "I agree" : "Continue");
      if (step.agree) await keeper.answer(state.at, { agreed: true, seconds }); else await keeper.done(state.at);
      break;
    }
    case "scale":
      await keeper.answer(state.at, await sheet(step, draft(state.at), (answers) => keepDraft(state.at, answers)));
      deleteDraft(state.at);
      break;
    case "controls": await choose(); await keeper.done(state.at); break;
    case "practice": case "drive": case "ride": await drives(state, step); break;
    case "thanks":
      await keeper.done(state.at);
      break;
  }
  return true;
}

function code(state: api.State): HTMLElement[] {
  const last = state.steps.at(-1);
  if (state.ended !== "done" || last?.kind !== "thanks") return [];
  const given = last.code ? [make("p", ["Your code: ", make("strong", [last.code])])] : [];
  return [...paragraphs(last.text), ...given];
}

/// The parts of earlier drives that the seat refuses for good, and why.
function leftOver(refused: string[]): void {
  if (refused.length === 0) return;
  const why = make("p", [`Something that was driven here before is not taken in: ${refused.join("; ")}. It stays in this browser; please tell whoever runs the study.`]);
  why.setAttribute("role", "alert");
  document.getElementById("main")?.before(why);
}

async function main(): Promise<void> {
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
  const again = pressed("Try again");
  void again.done.then(() => location.reload());
  // Nothing is read behind the road.
  (document.getElementById("drive") as HTMLElement).hidden = true;
  show(make("h1", ["This cannot go on"]), make("p", [why]), again.all);
});
