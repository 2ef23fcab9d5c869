// A drive or a ride: steps against the browser's clock, pictures between them, pieces to the server once a second.

import { PageDrive, type PageModel } from "../built/seat";
import * as api from "./api";
import * as controls from "./controls";
import { Outbox } from "./outbox";
import { named } from "./pads";
import { Asking, type Probe } from "./probe";
import { say } from "./say";
import { Sound } from "./sound";
import { roadOf, View, type Other } from "./view";
import { make } from "./words";

const STEP_MS = 10;
/// A picture that comes later than this is counted; more steps than this at once are left out.
const LATE_MS = 50, MOST_STEPS = 25;

const element = (id: string): HTMLElement => document.getElementById(id) as HTMLElement;

export interface Wanted {
  state: api.State; step: number; attempt: number;
  /// Who drives: a person by these means, or a model.
  ride: { model: PageModel; own: Float64Array; style: string; beyond: string | null; points: number; turns: number | null } | null;
  /// The record of the drive that a ride shows again.
  shown: string | null;
  seconds: number; seed: string;
  /// What is said above the speed, at first.
  hint: string;
  /// What is asked on the way.
  probe: Probe | null;
  /// Whether the drive may end now: for practice; asked each second.
  enough?: (seen: Practised) => boolean;
}

export interface Practised { keptS: number; passes: number }

/// A browser that a program drives says so, and so does the record.
const driver = navigator.webdriver ? "scripted" : "human";

/// What came of a drive: the fitted style where a model was given to learn with, and whether it ended with a crash.
export interface Ran { fit: string | null; crashed: boolean }

/// How long a crash is felt, where it is.
const FELT_MS = 1500;

/// Runs a drive to its end and sends it. A practice that ends with a crash is left as one that was cut short: it begins again.
export async function run(wanted: Wanted, learn: PageModel | null): Promise<Ran> {
  const { state, ride, shown } = wanted;
  const rides = ride !== null || shown !== null;
  const drive = shown !== null ? PageDrive.shown(state.scenario, wanted.seconds, wanted.seed, shown) : ride
    ? PageDrive.ride(state.scenario, wanted.seconds, wanted.seed, ride.model, ride.own, ride.style, ride.points)
    : PageDrive.by_hand(state.scenario, wanted.seconds, wanted.seed, driver);
  const road = roadOf(drive);
  const panel = element("drive");
  panel.hidden = false;
  const view = new View(element("view") as HTMLCanvasElement, road, state.view);
  const sound = new Sound();
  sound.start();
  const resized = (): void => view.resize();
  addEventListener("resize", resized);
  const unit = state.mph ? { factor: 2.23694, name: "mph" } : { factor: 3.6, name: "km/h" };
  element("posted").textContent = String(Math.round((drive.road()[2] as number) * unit.factor));
  element("said").textContent = wanted.hint;
  const outbox = new Outbox(wanted.step, wanted.attempt);
  await outbox.add(drive.header(), 1);
  const means = controls.chosen();
  controls.drives(true);
  let signal = 0, points = ride?.points ?? 0;
  const buttons = element("buttons");
  buttons.replaceChildren();
  const turn = (by: number): void => {
    const wanted = points + by;
    points = drive.turn(wanted);
    const sportier = points * (ride?.turns ?? 0) > 0;
    const style = Math.abs(points) < 0.5 ? say("own_style") : say(sportier ? "points_sportier" : "points_calmer", { n: Math.round(Math.abs(points)) });
    element("said").textContent = Math.abs(points - wanted) > 1e-9 ? say("far_as_goes", { style }) : style;
  };
  const button = (label: string, press: () => void): void => {
    const made = make("button", [label], { type: "button" });
    made.addEventListener("click", () => { press(); made.blur(); });
    buttons.append(made);
  };
  const uncomfortable = (): void => { drive.note("uncomfortable"); element("said").textContent = say("noted"); };
  if (rides) button(say("uncomfortable", { key: controls.keyName("U") }), uncomfortable);
  if (ride?.turns) {
    const by = ride.turns;
    button(say("calmer", { key: controls.keyName("C") }), () => turn(-by));
    button(say("sportier", { key: controls.keyName("S") }), () => turn(by));
  }
  let stopped = false, crashed = false;
  const stop = (why: string): void => { drive.note(`stopped: ${why}`); stopped = true; };
  button(say("unwell"), () => stop("unwell"));
  const note = (what: string, answer: number | null): void => drive.note(what, answer ?? undefined);
  const asking = wanted.probe && new Asking(wanted.probe, element("probe"), note, stop);
  const forget = controls.onPress((code) => {
    asking?.press(code);
    if (code === "KeyQ") signal = signal === 1 ? 0 : 1;
    if (code === "KeyE") signal = signal === -1 ? 0 : -1;
    if (code === "KeyM") sound.on = !sound.on;
    if (rides && code === "KeyU") uncomfortable();
    if (ride?.turns && code === "KeyC") turn(-ride.turns);
    if (ride?.turns && code === "KeyS") turn(ride.turns);
  });
  const hidden = (): void => drive.note(document.hidden ? "hidden" : "shown");
  document.addEventListener("visibilitychange", hidden);
  if (!rides) for (const text of controls.device(means)) drive.note(text);
  if (ride?.beyond) drive.note(`beyond: ${ride.beyond}`);
  const plugged = (event: GamepadEvent): void => drive.note(`${event.type === "gamepadconnected" ? "plugged in" : "unplugged"}: ${named(event.gamepad)}`);
  addEventListener("gamepadconnected", plugged);
  addEventListener("gamepaddisconnected", plugged);

  let drawn = 0, late = 0, dropped = 0, longest = 0, input = 0, before = performance.now(), owed = 0, sent = before, over = false, touched = 0;
  const speeds = new Map<number, { row: number; speed: number; braking: boolean; y: number; signal: number }>();
  let lastTicks = 0, plainness = "", paused: number | null = null, waiting: number | null = null;
  const piece = async (): Promise<void> => {
    const ticks = drive.ticks();
    if (ticks === lastTicks) return;
    lastTicks = ticks;
    if (view.plainness !== plainness) { plainness = view.plainness; drive.note(plainness); }
    const line = drive.chunk(Uint32Array.of(drawn, late, dropped, Math.round(longest), Math.round(input)));
    [drawn, late, dropped, longest, input] = [0, 0, 0, 0, 0];
    await outbox.add(line, ticks);
    void outbox.flush();
  };
  await new Promise<void>((finished) => {
    const frame = (now: number): void => {
      const passed = now - before;
      before = now;
      // Whoever is asked whether to leave does not drive meanwhile: the world waits, and the record says how long.
      if (document.querySelector("dialog[open]")) {
        if (paused === null) { paused = now; drive.note("paused: asked whether to leave"); }
        requestAnimationFrame(frame);
        return;
      }
      // A device that is gone: one step more, with which it is told at once; then the world waits for it.
      const missing = rides ? null : controls.gone(means);
      if (missing && waiting !== null) { requestAnimationFrame(frame); return; }
      if (paused !== null) { drive.note(`goes on after ${Math.round(now - paused)} ms`); paused = null; }
      if (waiting !== null) {
        drive.note(`device back after ${Math.round(now - waiting)} ms`);
        waiting = null;
        element("said").textContent = "";
      }
      drawn++;
      longest = Math.max(longest, passed);
      if (passed > LATE_MS) late++;
      owed += Math.max(0, passed);
      let steps = Math.floor(owed / STEP_MS);
      owed -= steps * STEP_MS;
      if (steps > MOST_STEPS) { dropped += steps - MOST_STEPS; steps = MOST_STEPS; }
      if (missing) steps = Math.min(steps, 1);
      let goesOn = true, pressedAt: number | null = null;
      if (steps > 0) {
        pressedAt = controls.takePressedAt();
        if (rides) goesOn = drive.rides(steps);
        else if (means.by === "keys") goesOn = drive.keys(controls.keys(), signal, steps);
        else if (means.by === "pad") { const [x, gas, stop] = controls.pad(means.pad); goesOn = drive.pad(x, gas, stop, signal, steps); }
        else { const [x, gas, stop] = controls.wheel(means.wheel); goesOn = drive.wheel(x, gas, stop, signal, steps); }
      }
      const seen = drive.seen();
      const get = (i: number): number => seen[i] as number;
      const [since, row, x, y, heading, speed, wheel, , , lane, from] = [get(0), get(1), get(2), get(3), get(4), get(5), get(6), get(7), get(8), get(9), get(10)];
      const others: Other[] = [];
      for (let i = 14; i + 3 < seen.length; i += 4) {
        const [id, ox, oy, v] = [get(i), get(i + 1), get(i + 2), get(i + 3)];
        let known = speeds.get(id);
        if (!known) { known = { row, speed: v, braking: false, y: oy, signal: 0 }; speeds.set(id, known); }
        if (row > known.row) {
          const dt = row - known.row, aside = (oy - known.y) / dt;
          known.braking = (v - known.speed) / dt < -0.5;
          known.signal = Math.abs(aside) > 0.1 ? Math.sign(aside) : 0;
          Object.assign(known, { row, speed: v, y: oy });
        }
        others.push({ id, x: ox + v * (since + owed / 1000), y: oy, speed: v, braking: known.braking, signal: known.signal });
      }
      const turning = ride ? (from >= 0 && lane !== from ? Math.sign(lane - from) : 0) : shown !== null ? get(11) : signal;
      const blink = Math.floor(now / 380) % 2 === 0;
      element("left").classList.toggle("on", turning > 0 && blink);
      element("right").classList.toggle("on", turning < 0 && blink);
      element("speed").textContent = `${Math.round(speed * unit.factor)} ${unit.name}`;
      if (get(8) > touched) { touched = get(8); element("said").textContent = say("contact_barrier"); }
      if (get(7) > 0 && !crashed) { crashed = true; drive.note("crash"); goesOn = false; }
      sound.set(speed, get(12));
      view.draw({ x: x + speed * owed / 1000, y, heading, wheel, others }, now);
      if (pressedAt !== null) input = Math.max(input, performance.now() - pressedAt);
      if (now - sent >= 1000) {
        sent = now;
        void piece();
        const [keptS = 0, passes = 0] = drive.practised();
        if (wanted.enough?.({ keptS, passes })) goesOn = false;
        asking?.tick(drive.ticks() * STEP_MS / 1000);
        if (outbox.refused) { element("said").textContent = outbox.refused.message; goesOn = false; }
      }
      if (missing && steps > 0) {
        waiting = now;
        drive.note(`device gone: ${named(missing)}`);
        void piece();
        element("said").textContent = say("device_gone", { name: named(missing) });
      }
      if (!goesOn || stopped) over = true;
      if (over) finished(); else requestAnimationFrame(frame);
    };
    requestAnimationFrame((now) => { before = now; frame(now); });
  });
  asking?.close();
  if (crashed && state.crash === "felt") {
    sound.bang();
    panel.classList.add("felt");
    await new Promise((done) => setTimeout(done, FELT_MS));
    panel.classList.remove("felt");
  }
  const rest = drive.ticks();
  document.removeEventListener("visibilitychange", hidden);
  removeEventListener("gamepadconnected", plugged);
  removeEventListener("gamepaddisconnected", plugged);
  await piece();
  const driven = drive.finish();
  // What has no end is begun again.
  if (!crashed || !wanted.enough) await outbox.add(driven.end(), rest);
  controls.drives(false);
  forget();
  removeEventListener("resize", resized);
  sound.stop();
  view.dispose();
  // A canvas whose drawing was given back cannot be drawn on again.
  const canvas = element("view");
  canvas.replaceWith(canvas.cloneNode());
  panel.hidden = true;
  const fit = learn && !stopped ? driven.fit(learn) : null;
  while (!outbox.empty && !outbox.refused) {
    await outbox.flush();
    if (!outbox.empty) await new Promise((later) => setTimeout(later, 700));
  }
  if (outbox.refused?.reason === "over") await outbox.drop();
  if (outbox.refused) throw outbox.refused;
  return { fit, crashed };
}
