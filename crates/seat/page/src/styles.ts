// One's own style beside those of the others.

import type { Styles } from "./api";
import { say } from "./say";
import { make } from "./words";

const SVG = "http://www.w3.org/2000/svg";
const WIDTH = 600;
const HEIGHT = 110;
const EDGE = 30;
const LINE = 62;
/// Points closer than this stand above each other.
const APART = 12;

function draw<K extends keyof SVGElementTagNameMap>(tag: K, attributes: Record<string, string | number>, text = ""): SVGElementTagNameMap[K] {
  const element = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, String(value));
  element.textContent = text;
  return element;
}

/// A line from calmer to sportier with a ring for each of the others and a mark for oneself; the same in words above it.
export function styles({ own, others, sportier_up }: Styles): HTMLElement[] {
  const title = make("h2", [say("style_title")]);
  if (own === null) {
    return [title, make("p", [say("style_unknown")])];
  }
  const towards = (points: number): number => (sportier_up ? points : -points);
  const all = [...others, own].map(towards);
  const [low, high] = [Math.min(...all), Math.max(...all)];
  const at = (points: number): number => EDGE + ((towards(points) - low) / (high - low || 1)) * (WIDTH - 2 * EDGE);
  const calmer = others.filter((o) => towards(o) < towards(own)).length;
  const words = say("style_among", { calmer, others: others.length });
  const picture = draw("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: "img", class: "styles" });
  picture.append(draw("title", {}, words), draw("line", { x1: EDGE, x2: WIDTH - EDGE, y1: LINE, y2: LINE }));
  let [before, row] = [-Infinity, 0];
  for (const x of others.map(at).sort((a, b) => a - b)) {
    row = x - before < APART ? row + 1 : 0;
    if (row === 0) before = x;
    picture.append(draw("circle", { cx: x.toFixed(1), cy: LINE - 7 - 9 * Math.min(row, 4), r: 4 }));
  }
  const here = at(own).toFixed(1);
  picture.append(draw("path", { d: `M${here} ${LINE + 3}l-7 14h14z` }));
  picture.append(draw("text", { x: here, y: LINE + 34, "text-anchor": "middle" }, say("style_you")));
  picture.append(draw("text", { x: EDGE, y: LINE + 34, "text-anchor": "start", class: "end" }, say("style_calmer")));
  picture.append(draw("text", { x: WIDTH - EDGE, y: LINE + 34, "text-anchor": "end", class: "end" }, say("style_sportier")));
  // At an end the word for oneself would stand on the word of that end.
  if (at(own) < EDGE + 70) picture.querySelectorAll("text")[1]?.remove();
  if (at(own) > WIDTH - EDGE - 80) [...picture.querySelectorAll("text")].at(-1)?.remove();
  const figure = make("figure", [picture]);
  return [title, make("p", [words]), figure];
}
