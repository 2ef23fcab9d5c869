// What stands above every page: how far somebody has come, and the screen to be filled.

import type { State } from "./api";
import { duration, say } from "./say";
import { make } from "./words";

const element = (id: string): HTMLElement => document.getElementById(id) as HTMLElement;

/// Says which step this is, and how long is still driven at most: nobody knows how long somebody reads or answers.
export function sayHowFar({ steps, at, ended }: State): void {
  // Only whoever stops is told what is told then.
  const path = steps.flatMap((step, i) => (step.kind === "aftercare" && i !== at ? [] : [i]));
  const place = path.indexOf(at);
  if (ended || place < 0) { element("far").replaceChildren(); return; }
  const seconds = drivenFrom(steps.slice(at));
  const left = seconds > 0 ? [make("span", [`, ${say("far_driving", { time: duration(seconds) })}`], { className: "wide" })] : [];
  element("far").replaceChildren(say("far", { step: place + 1, of: path.length }), ...left);
}

/// How long is driven at most in this session, in s; nothing once somebody stopped.
function drivenFrom(ahead: State["steps"]): number {
  const next = ahead.findIndex((step, i) => i > 0 && step.kind === "between");
  return ahead.slice(0, next < 0 ? ahead.length : next).reduce((sum, step) => sum + ("seconds" in step ? step.seconds : 0), 0);
}

/// The button that fills the screen, where the browser can and it is not filled.
export function offerFullScreen(): void {
  const button = element("full");
  const look = (): void => { button.hidden = !document.fullscreenEnabled || document.fullscreenElement !== null; };
  button.addEventListener("click", () => { void document.documentElement.requestFullscreen().catch(() => {}); button.blur(); });
  document.addEventListener("fullscreenchange", look);
  look();
}
