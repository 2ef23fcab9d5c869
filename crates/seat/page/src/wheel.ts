// A steering wheel of any range and its pedals, of one device or two: found out by moving each, and tried before it counts.

import { named, padAt, pads, type Device } from "./pads";
import { say } from "./say";
import { make, pressed, show } from "./words";

interface Pedal { device: Device; axis: number; rest: number; down: number }

/// How a wheel was found to be: where it stands straight and at its ends, and how far it turns from one to the other.
export interface Wheel { device: Device; axis: number; left: number; centre: number; right: number; rangeDegrees: number; throttle: Pedal; brake: Pedal }

/// From one end to the other, in degrees: what there are wheels of, and the most common.
const RANGE = { least: 90, most: 2520, common: 900 };
/// An axis that moved less was not meant.
const MOVED = 0.2;

const share = (now: number, from: number, to: number): number => (to === from ? 0 : (now - from) / (to - from));

/// Turn of the wheel in rad (left positive), throttle, brake; straight and nothing pressed of what is gone.
export function turnOf(w: Wheel): [number, number, number] {
  const now = (device: Device, axis: number, rest: number): number => padAt(device)?.axes[axis] ?? rest;
  const at = now(w.device, w.axis, w.centre);
  const [left, right] = [share(at, w.centre, w.left), share(at, w.centre, w.right)];
  const turned = (left > 0 ? left : -Math.max(0, right)) * w.rangeDegrees / 2 * Math.PI / 180;
  const pedal = (p: Pedal): number => Math.min(1, Math.max(0, share(now(p.device, p.axis, p.rest), p.rest, p.down)));
  return [turned, pedal(w.throttle), pedal(w.brake)];
}

/// Every axis of every device, as it is now.
interface Axis { device: Device; axis: number; value: number }
const look = (): Axis[] => pads().flatMap(({ id, index, axes }) => axes.map((value, axis) => ({ device: { id, index }, axis, value })));

const same = (one: Axis, other: Axis): boolean => one.axis === other.axis && one.device.index === other.device.index && one.device.id === other.device.id;
const valueOf = (axes: Axis[], axis: Axis): number => axes.find((a) => same(a, axis))?.value ?? axis.value;

/// The axis that moved most between two looks, of those that are nothing else.
function moved(before: Axis[], after: Axis[], not: Axis[]): Axis | null {
  let best: Axis | null = null, most = MOVED;
  for (const axis of after) {
    const by = Math.abs(axis.value - valueOf(before, axis));
    if (by > most && !not.some((other) => same(other, axis))) [best, most] = [axis, by];
  }
  return best;
}

async function ask(name: string): Promise<Axis[]> {
  const go = pressed(say("done"));
  show(make("h1", [say("wheel")]), make("p", [say(name)]), go.all);
  await go.done;
  return look();
}

/// Asks how far the wheel turns.
async function asksRange(): Promise<number> {
  const field = make("input", [], { type: "number", min: String(RANGE.least), max: String(RANGE.most), value: String(RANGE.common), id: "range" });
  const label = make("label", [say("wheel_range")], { htmlFor: "range" });
  for (;;) {
    const go = pressed(say("done"));
    show(make("h1", [say("wheel")]), make("p", [label]), make("p", [field]), make("p", [say("wheel_range_help", { min: RANGE.least, max: RANGE.most })]), go.all);
    await go.done;
    const given = field.valueAsNumber;
    if (given >= RANGE.least && given <= RANGE.most) return given;
  }
}

/// Measures wheel and pedals, and lets them be tried; none where something did not move, or the person goes back.
export async function measure(): Promise<Wheel | null> {
  const rest = await ask("wheel_rest");
  const left = await ask("wheel_left");
  const turn = moved(rest, left, []);
  if (!turn) return didNotMove("wheel");
  const right = await ask("wheel_right");
  const ends = [valueOf(left, turn), valueOf(right, turn)] as const, centre = valueOf(rest, turn);
  // Both ends on one side: it was not turned to the other.
  if ((ends[0] - centre) * (ends[1] - centre) >= 0) return didNotMove("wheel");
  const gas = await ask("wheel_throttle");
  const throttle = moved(rest, gas, [turn]);
  if (!throttle) return didNotMove("accelerator");
  const stop = await ask("wheel_brake");
  const brake = moved(rest, stop, [turn, throttle]);
  if (!brake) return didNotMove("brake");
  const pedal = (axis: Axis, pressedDown: Axis[]): Pedal => ({ device: axis.device, axis: axis.axis, rest: valueOf(rest, axis), down: valueOf(pressedDown, axis) });
  const wheel: Wheel = {
    device: turn.device, axis: turn.axis, left: ends[0], centre, right: ends[1], rangeDegrees: await asksRange(), throttle: pedal(throttle, gas), brake: pedal(brake, stop),
  };
  return (await tried(wheel)) ? wheel : null;
}

async function didNotMove(what: "wheel" | "accelerator" | "brake"): Promise<null> {
  const again = pressed(say("back"));
  show(make("h1", [say("wheel")]), make("p", [say("did_not_move", { what: say(what) })]), again.all);
  await again.done;
  return null;
}

/// Shows where wheel and pedals are until the person is content; false to measure them again.
async function tried(wheel: Wheel): Promise<boolean> {
  const now = make("p", []);
  const go = pressed(say("continue")), again = pressed(say("measure_again"));
  again.button.className = "";
  const devices = [...new Set([wheel.device, wheel.throttle.device, wheel.brake.device].map(named))].join(", ");
  show(make("h1", [say("wheel_try")]), make("p", [devices]), now, go.all, again.all);
  const tell = (): void => {
    const [turned, gas, stop] = turnOf(wheel);
    const percent = (part: number): number => Math.round(100 * part);
    now.textContent = say("wheel_now", { degrees: Math.round(turned * 180 / Math.PI), gas: percent(gas), brake: percent(stop) });
  };
  tell();
  const timer = setInterval(tell, 50);
  const content = await Promise.race([go.done.then(() => true), again.done.then(() => false)]);
  clearInterval(timer);
  return content;
}
