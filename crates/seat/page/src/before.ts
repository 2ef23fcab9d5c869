// What the page needs of its browser, looked at before anything is asked of a person.

import { token, type State } from "./api";
import { say } from "./say";
import { make, pressed, show } from "./words";

/// How long the tab before (one that is just being closed or reloaded) may take to go, in ms.
const GOES_WITHIN_MS = 2000;

/// Takes the study for this tab as long as it is open: a second one says so and does not drive. Another browser's tab, and one of a
/// browser without locks, is told by the server.
export async function onlyTab(): Promise<void> {
  if (!navigator.locks) return;
  await new Promise<void>((done, failed) => {
    const held = navigator.locks.request(`maveric-seat ${token}`, { signal: AbortSignal.timeout(GOES_WITHIN_MS) }, () => {
      done();
      return new Promise(() => {});
    });
    held.catch(() => failed(new Error(say("open_in_tab"))));
  });
}

/// Whether the browser draws the road at all.
export const draws = (): boolean => {
  const gl = document.createElement("canvas").getContext("webgl2");
  gl?.getExtension("WEBGL_lose_context")?.loseContext();
  return gl !== null;
};

/// A phone or a tablet: fingers, and neither mouse nor keyboard.
const fingersOnly = (): boolean => matchMedia("(pointer: coarse)").matches && !matchMedia("(any-pointer: fine)").matches;

/// Stops where the road cannot be drawn, and tells whoever has no keyboard; nothing where nothing is left to drive.
export async function checkBrowser(state: State): Promise<void> {
  const left = state.ended ? [] : state.steps.slice(state.at);
  // What a study needs is looked at there.
  if (left[0]?.kind === "computer") return;
  if (!left.some((step) => step.kind === "practice" || step.kind === "drive" || step.kind === "ride")) return;
  if (!draws()) {
    throw new Error(say("no_webgl"));
  }
  if (!fingersOnly()) return;
  const go = pressed(say("all_the_same"));
  show(make("h1", [say("on_a_computer")]),
    make("p", [say("no_keyboard")]), go.all);
  await go.done;
}
