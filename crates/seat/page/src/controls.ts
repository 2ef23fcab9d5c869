// Keyboard, gamepad and wheel: where hands and feet are now.

import { say } from "./say";
import { make, pressed, show } from "./words";
import { measure, turnOf, type Wheel } from "./wheel";
import { named, padAt, pads, type Device } from "./pads";

export type Means = { by: "keys" } | { by: "pad"; pad: Device } | { by: "wheel"; wheel: Wheel };

const down = new Set<string>();
const presses: ((code: string) => void)[] = [];
const ours = ["ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown", "Space"];
/// When the first key that drives went down since it was last asked, by the browser's clock; none went down: null.
let pressedAt: number | null = null;
/// Whether keys drive: outside of a drive they scroll and press buttons.
let driving = false;

addEventListener("keydown", (event) => {
  if (!driving) return;
  if (ours.includes(event.code)) event.preventDefault();
  if (!event.repeat) {
    for (const take of presses) take(event.code);
    if (bits.some(([code]) => code === event.code)) pressedAt ??= event.timeStamp;
  }
  down.add(event.code);
});
addEventListener("keyup", (event) => down.delete(event.code));
addEventListener("blur", () => down.clear());

export function drives(now: boolean): void { driving = now; down.clear(); }
export function takePressedAt(): number | null {
  const at = pressedAt;
  pressedAt = null;
  return at;
}
export function onPress(take: (code: string) => void): () => void {
  presses.push(take);
  return () => { presses.splice(presses.indexOf(take), 1); };
}

const bits: [string, number][] = [
  ["ArrowLeft", 1], ["KeyA", 1], ["ArrowRight", 2], ["KeyD", 2], ["ArrowUp", 4], ["KeyW", 4], ["ArrowDown", 8], ["KeyS", 8], ["Space", 16],
];

export const keys = (): number => bits.reduce((sum, [code, bit]) => (down.has(code) ? sum | bit : sum), 0);

/// What the keys of this keyboard say, by where they are; nothing where the browser does not tell.
const layout: Promise<ReadonlyMap<string, string> | undefined> =
  (navigator as { keyboard?: { getLayoutMap?(): Promise<ReadonlyMap<string, string>> } }).keyboard?.getLayoutMap?.().catch(() => undefined) ?? Promise.resolve(undefined);
let known: ReadonlyMap<string, string> | undefined;
void layout.then((map) => { known = map; });

/// What the key says that stands where a keyboard of the United States has this letter.
export const keyName = (letter: string): string => (/^[A-Z]$/.test(letter) ? known?.get(`Key${letter}`)?.toUpperCase() : undefined) ?? letter;

/// What somebody drives with, as the record has it: the device, and how it was measured.
export function device(means: Means): string[] {
  switch (means.by) {
    case "keys": return ["device: keyboard"];
    case "pad": return [`device: gamepad, ${padAt(means.pad) ? named(means.pad) : "not connected"}`];
    case "wheel": {
      const { wheel: w } = means;
      const pedals = [w.throttle, w.brake].map((p) => p.device).filter((d) => d.id !== w.device.id || d.index !== w.device.index);
      const [one] = pedals;
      const axis = (name: string, at: number, values: number[]): string => `${name} axis ${at} ${values.map((v) => v.toFixed(2)).join(" ")}`;
      return [
        `device: wheel, ${padAt(w.device) ? named(w.device) : "not connected"}`, ...(one ? [`pedals: ${named(one)}`] : []),
        `measured: ${w.rangeDegrees} degrees, ${axis("wheel", w.axis, [w.left, w.centre, w.right])}, ${axis("accelerator", w.throttle.axis, [w.throttle.rest, w.throttle.down])}, ${axis("brake", w.brake.axis, [w.brake.rest, w.brake.down])}`,
      ];
    }
  }
}

/// The device that somebody drives with and that is not there; none where all are.
export function gone(means: Means): Device | null {
  const needed = means.by === "pad" ? [means.pad] : means.by === "wheel" ? [means.wheel.device, means.wheel.throttle.device, means.wheel.brake.device] : [];
  return needed.find((device) => !padAt(device)) ?? null;
}

/// Left positive, throttle, brake, of a gamepad; nothing held where it is gone.
export function pad(device: Device): [number, number, number] {
  const found = padAt(device);
  if (!found) return [0, 0, 0];
  const x = found.axes[0] ?? 0;
  const dead = Math.abs(x) < 0.06 ? 0 : x;
  return [-dead, found.buttons[7]?.value ?? 0, found.buttons[6]?.value ?? 0];
}

export const wheel = turnOf;

const STORED = "maveric-seat-controls-2";

export function chosen(): Means {
  try {
    const means = JSON.parse(localStorage.getItem(STORED) ?? "") as Means;
    if (means.by === "keys" || means.by === "pad" || means.by === "wheel") return means;
  } catch { /* nothing was chosen yet */ }
  return { by: "keys" };
}

/// A sentence in which [Q] is drawn as a key, by what it says on this keyboard.
export const withKeys = (sentence: string): (Node | string)[] =>
  sentence.split(/\[([^\]]+)\]/).map((part, at) => (at % 2 === 1 ? make("kbd", [keyName(part)]) : part));

type By = Means["by"];

/// Lets the person choose, where the study does not say with what everybody drives, and a wheel be measured.
export async function choose(needed: "keyboard" | "wheel" | null): Promise<void> {
  const offered: By[] = needed === "keyboard" ? ["keys"] : needed === "wheel" ? ["wheel"] : ["keys", "pad", "wheel"];
  await layout;
  for (;;) {
    const choice = await new Promise<By>((resolve) => {
      const option = (by: By, label: string): HTMLElement => {
        const button = make("button", [label], { type: "button", className: by === offered[0] ? "main" : "" });
        button.addEventListener("click", () => resolve(by));
        return make("p", [button], { hidden: !offered.includes(by) });
      };
      show(
        make("h1", [say("how_drive")]),
        make("p", withKeys(say("keys_help"))),
        make("p", [say("devices_help")]),
        option("keys", say("keyboard")), option("pad", say("gamepad")), option("wheel", say("wheel_and_pedals")),
      );
    });
    const means = choice === "keys" ? { by: choice } : choice === "pad" ? await padChosen() : await wheelChosen();
    if (!means) continue;
    localStorage.setItem(STORED, JSON.stringify(means));
    return;
  }
}

async function nothingThere(): Promise<null> {
  const again = pressed(say("back"));
  show(make("h1", [say("not_found")]), make("p", [say("no_device")]), again.all);
  await again.done;
  return null;
}

/// The gamepad: of several the one of which a button is pressed.
async function padChosen(): Promise<Means | null> {
  const there = pads();
  const [first] = there;
  if (!first) return nothingThere();
  if (there.length === 1) return { by: "pad", pad: { id: first.id, index: first.index } };
  const back = pressed(say("back"));
  show(make("h1", [say("gamepad")]), make("p", [say("press_its_button")]), make("ul", there.map((p) => make("li", [named(p)]))), back.all);
  let left = false;
  void back.done.then(() => { left = true; });
  while (!left) {
    const found = pads().find((p) => p.buttons.some((button) => button.pressed));
    if (found) return { by: "pad", pad: { id: found.id, index: found.index } };
    await new Promise((later) => setTimeout(later, 50));
  }
  return null;
}

async function wheelChosen(): Promise<Means | null> {
  if (pads().length === 0) return nothingThere();
  const wheel = await measure();
  return wheel && { by: "wheel", wheel };
}
