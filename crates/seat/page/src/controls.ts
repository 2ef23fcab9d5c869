// Keyboard, gamepad and wheel: where hands and feet are now.

import { say } from "./say";
import { make, pressed, show } from "./words";

/// How a wheel's axes were found to be: at rest and at their ends.
interface Wheel { axis: number; centre: number; left: number; lockDegrees: number; throttle: Pedal; brake: Pedal }
interface Pedal { axis: number; rest: number; down: number }

export type Means = { by: "keys" } | { by: "pad" } | { by: "wheel"; wheel: Wheel };

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

const pads = (): Gamepad[] => navigator.getGamepads().filter((p): p is Gamepad => p !== null && p.connected);

/// Letters of a device's name that are written down: an event is at most 200 bytes, a letter at most three.
const LONGEST_NAME = 50;
export const named = (pad: Gamepad): string => pad.id.slice(0, LONGEST_NAME);

/// What somebody drives with, as the record has it.
export function device(means: Means): string {
  if (means.by === "keys") return "keyboard";
  const found = pads()[0];
  return `${means.by === "pad" ? "gamepad" : "wheel"}, ${found ? named(found) : "not connected"}`;
}

/// Left positive, throttle, brake, of a gamepad.
export function pad(): [number, number, number] {
  const found = pads()[0];
  if (!found) return [0, 0, 0];
  const x = found.axes[0] ?? 0;
  const dead = Math.abs(x) < 0.06 ? 0 : x;
  return [-dead, found.buttons[7]?.value ?? 0, found.buttons[6]?.value ?? 0];
}

const share = (now: number, from: number, to: number): number => (to === from ? 0 : (now - from) / (to - from));

/// Turn of the wheel in rad (left positive), throttle, brake.
export function wheel(w: Wheel): [number, number, number] {
  const axes = pads()[0]?.axes ?? [];
  const turned = share(axes[w.axis] ?? w.centre, w.centre, w.left) * w.lockDegrees * Math.PI / 180;
  const pedal = (p: Pedal): number => Math.min(1, Math.max(0, share(axes[p.axis] ?? p.rest, p.rest, p.down)));
  return [turned, pedal(w.throttle), pedal(w.brake)];
}

const STORED = "maveric-seat-controls";

export function chosen(): Means {
  try {
    const means = JSON.parse(localStorage.getItem(STORED) ?? "") as Means;
    if (means.by === "keys" || means.by === "pad" || means.by === "wheel") return means;
  } catch { /* nothing was chosen yet */ }
  return { by: "keys" };
}

/// The axis that moved most between two looks.
function moved(before: readonly number[], after: readonly number[], not: number[] = []): number {
  let best = -1, most = 0.2;
  after.forEach((value, axis) => {
    const by = Math.abs(value - (before[axis] ?? 0));
    if (by > most && !not.includes(axis)) [best, most] = [axis, by];
  });
  return best;
}

async function calibrate(): Promise<Wheel | null> {
  const look = (): number[] => [...(pads()[0]?.axes ?? [])];
  const ask = async (name: string): Promise<number[]> => {
    const go = pressed(say("done"));
    show(make("h1", [say("wheel")]), make("p", [say(name)]), go.all);
    await go.done;
    return look();
  };
  const rest = await ask("wheel_rest");
  const left = await ask("wheel_left");
  const axis = moved(rest, left);
  const gas = await ask("wheel_throttle");
  const throttle = moved(rest, gas, [axis]);
  const stop = await ask("wheel_brake");
  const brake = moved(rest, stop, [axis, throttle]);
  if (axis < 0 || throttle < 0 || brake < 0) return null;
  const at = (from: number[], which: number): number => from[which] ?? 0;
  return {
    axis, centre: at(rest, axis), left: at(left, axis), lockDegrees: 450,
    throttle: { axis: throttle, rest: at(rest, throttle), down: at(gas, throttle) },
    brake: { axis: brake, rest: at(rest, brake), down: at(stop, brake) },
  };
}

/// A sentence in which [Q] is drawn as a key.
const withKeys = (sentence: string): (Node | string)[] =>
  sentence.split(/\[([^\]]+)\]/).map((part, at) => (at % 2 === 1 ? make("kbd", [part]) : part));

/// Lets the person choose, and a wheel be measured.
export async function choose(): Promise<void> {
  for (;;) {
    const choice = await new Promise<"keys" | "pad" | "wheel">((resolve) => {
      const option = (by: "keys" | "pad" | "wheel", label: string): HTMLElement => {
        const button = make("button", [label], { type: "button", className: by === "keys" ? "main" : "" });
        button.addEventListener("click", () => resolve(by));
        return make("p", [button]);
      };
      show(
        make("h1", [say("how_drive")]),
        make("p", withKeys(say("keys_help"))),
        make("p", [say("devices_help")]),
        option("keys", say("keyboard")), option("pad", say("gamepad")), option("wheel", say("wheel_and_pedals")),
      );
    });
    if (choice !== "keys" && pads().length === 0) {
      const again = pressed(say("back"));
      show(make("h1", [say("not_found")]), make("p", [say("no_device")]), again.all);
      await again.done;
      continue;
    }
    let means: Means = choice === "wheel" ? { by: "keys" } : { by: choice };
    if (choice === "wheel") {
      const found = await calibrate();
      if (!found) continue;
      means = { by: "wheel", wheel: found };
    }
    localStorage.setItem(STORED, JSON.stringify(means));
    return;
  }
}
