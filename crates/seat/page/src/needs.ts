// What a study needs of a computer: looked at before anybody agrees, and told so that it can be mended. No number leaves the page.

import type { Need, State } from "./api";
import { draws } from "./before";
import { withKeys } from "./controls";
import { paceOf } from "./pace";
import { say } from "./say";
import { make, pressed, show } from "./words";

/// How often it is looked whether something has changed, in ms.
const LOOKED_EVERY_MS = 250;

/// What was seen so far: none where it was not looked at yet.
interface Seen { webgl: boolean; pictures: number | null; keyboard: boolean; wheel: boolean }

const holds = (need: Need, seen: Seen): boolean => {
  switch (need.what) {
    case "webgl": return seen.webgl;
    case "pictures_per_second": return seen.pictures !== null && seen.pictures >= need.least;
    case "width_px": return innerWidth >= need.least;
    case "height_px": return innerHeight >= need.least;
    case "device": return need.device === "wheel" ? seen.wheel : seen.keyboard;
  }
};

function told(need: Need, seen: Seen): string {
  switch (need.what) {
    case "webgl": return say("need_webgl");
    case "pictures_per_second": return say("need_pictures", { least: need.least, now: seen.pictures === null ? say("not_looked") : Math.round(seen.pictures) });
    case "width_px": return say("need_width", { least: need.least, now: innerWidth });
    case "height_px": return say("need_height", { least: need.least, now: innerHeight });
    case "device": return say(need.device === "wheel" ? "need_wheel" : "need_keyboard");
  }
}

/// Shows what is needed until all of it is there, or the person cannot change it: gives the place of the first need that is missing then.
export async function lookAtComputer(state: State, needs: Need[]): Promise<number | null> {
  const seen: Seen = { webgl: draws(), pictures: null, keyboard: false, wheel: false };
  const asked = needs.some((need) => need.what === "pictures_per_second");
  const key = (event: KeyboardEvent): void => { if (event.code === "ArrowRight") seen.keyboard = true; };
  addEventListener("keydown", key);
  try {
    if (asked && seen.webgl) seen.pictures = await paceOf(state);
    for (;;) {
      const missing = await shown(needs, seen, asked);
      if (missing !== "again") return missing;
      seen.webgl = draws();
      if (asked && seen.webgl) seen.pictures = await paceOf(state);
    }
  } finally {
    removeEventListener("keydown", key);
  }
}

/// The page of what is needed, until it is left: with nothing missing, with what is, or to look at the road again.
async function shown(needs: Need[], seen: Seen, asked: boolean): Promise<number | null | "again"> {
  const rows = needs.map(() => make("li", []));
  const go = pressed(say("continue"));
  const again = pressed(say("look_again"));
  again.button.className = "";
  const cannot = pressed(say("cannot_change"));
  cannot.button.className = "";
  const missing = make("div", [make("p", [say("needs_mend")]), ...(asked ? [again.all] : []), cannot.all]);
  const look = (): void => {
    seen.wheel = navigator.getGamepads().some((pad) => pad?.connected);
    needs.forEach((need, i) => {
      const there = holds(need, seen), row = rows[i] as HTMLElement;
      const text = [make("span", [there ? "✓ " : "✗ "], { ariaHidden: "true" }), ...withKeys(told(need, seen)), make("span", [say(there ? "need_met" : "need_missing")], { className: "unseen" })];
      const before = row.textContent;
      if (before !== text.map((part) => (typeof part === "string" ? part : part.textContent)).join("")) row.replaceChildren(...text);
      row.classList.toggle("missing", !there);
    });
    const all = needs.every((need) => holds(need, seen));
    go.button.hidden = !all;
    missing.hidden = all;
  };
  look();
  const list = make("ul", rows, { className: "needs" });
  list.setAttribute("aria-live", "polite");
  show(make("h1", [say("needs_title")]), make("p", [say("needs_help")]), list, go.all, missing);
  const timer = setInterval(look, LOOKED_EVERY_MS);
  const left = await Promise.race([go.done.then(() => "all"), again.done.then(() => "again"), cannot.done.then(() => "cannot")]);
  clearInterval(timer);
  if (left === "again") return "again";
  const first = needs.findIndex((need) => !holds(need, seen));
  return left === "all" || first < 0 ? null : first;
}
