// How many pictures of the road a second this browser draws: a car that nobody steers, looked at for some seconds and kept nowhere.

import { PageDrive } from "../built/seat";
import type { State } from "./api";
import { say } from "./say";
import { roadOf, View, type Other } from "./view";

/// The picture gets plainer by itself in the first seconds; what counts are those after them, in s.
const SETTLES_S = 5, COUNTED_S = 2;
const STEP_MS = 10, MOST_STEPS = 25, FASTER = 4;

const element = (id: string): HTMLElement => document.getElementById(id) as HTMLElement;

/// Draws the study's road in this window as a drive does; gives pictures a second.
export async function paceOf(state: State): Promise<number> {
  const drive = PageDrive.by_hand(state.scenario, SETTLES_S + COUNTED_S + 3, "1", "scripted");
  element("drive").hidden = false;
  const view = new View(element("view") as HTMLCanvasElement, roadOf(drive), state.view);
  element("said").textContent = say("looking");
  element("buttons").replaceChildren();
  let counted = 0;
  await new Promise<void>((finished) => {
    let begun: number | null = null, before = 0, owed = 0;
    const frame = (now: number): void => {
      begun ??= now;
      owed += before > 0 ? now - before : 0;
      before = now;
      const steps = Math.min(MOST_STEPS, Math.floor(owed / STEP_MS));
      owed -= steps * STEP_MS;
      if (steps > 0) drive.keys(FASTER, 0, steps);
      const [, , x = 0, y = 0, heading = 0, , wheel = 0, , , , , , , , ...seen] = drive.seen();
      const others: Other[] = [];
      for (let i = 0; i + 3 < seen.length; i += 4) {
        const [id, ox, oy, speed] = seen.slice(i, i + 4) as [number, number, number, number];
        others.push({ id, x: ox, y: oy, speed, braking: false, signal: 0 });
      }
      view.draw({ x, y, heading, wheel, others }, now);
      const passed_s = (now - begun) / 1000;
      if (passed_s > SETTLES_S) counted++;
      if (passed_s > SETTLES_S + COUNTED_S) finished(); else requestAnimationFrame(frame);
    };
    requestAnimationFrame(frame);
  });
  view.dispose();
  // A canvas whose drawing was given back cannot be drawn on again.
  const canvas = element("view");
  canvas.replaceWith(canvas.cloneNode());
  element("drive").hidden = true;
  drive.free();
  return counted / COUNTED_S;
}
