// Words on the sheets of a PDF as Chromium prints it: streams are inflated, glyphs read back by the fonts' own tables.

import { inflateSync } from "node:zlib";

/** Every stream of the file, inflated where it is packed. */
function streams(pdf) {
  const text = pdf.toString("latin1");
  const found = [];
  for (const match of text.matchAll(/stream\r?\n/g)) {
    const from = match.index + match[0].length;
    const to = text.indexOf("endstream", from);
    const bytes = pdf.subarray(from, to);
    try {
      found.push(inflateSync(bytes).toString("latin1"));
    } catch {
      found.push(bytes.toString("latin1"));
    }
  }
  return found;
}

/** Glyph number to letters, as a ToUnicode table says. */
function letters(table) {
  const map = new Map();
  const word = (hex) => String.fromCharCode(...(hex.match(/.{4}/g) ?? []).map((h) => parseInt(h, 16)));
  for (const block of table.matchAll(/beginbfchar([\s\S]*?)endbfchar/g)) {
    for (const [, from, to] of block[1].matchAll(/<(\w+)>\s*<(\w+)>/g)) map.set(parseInt(from, 16), word(to));
  }
  for (const block of table.matchAll(/beginbfrange([\s\S]*?)endbfrange/g)) {
    for (const [, low, high, to] of block[1].matchAll(/<(\w+)>\s*<(\w+)>\s*<(\w+)>/g)) {
      for (let i = parseInt(low, 16), k = 0; i <= parseInt(high, 16); i++, k++) map.set(i, String.fromCharCode(parseInt(to, 16) + k));
    }
  }
  return map;
}

/** On how many sheets `wanted` is printed; pieces of a line are joined, so kerning does not part it. */
export function sheetsWith(pdf, wanted) {
  const all = streams(pdf);
  const tables = all.filter((s) => s.includes("beginbfchar") || s.includes("beginbfrange")).map(letters);
  const printed = all.filter((s) => /\bTj\b|\bTJ\b/.test(s));
  const shown = (stream, map) =>
    [...stream.matchAll(/<([0-9A-Fa-f]+)>/g)].map(([, hex]) => (hex.match(/.{4}/g) ?? []).map((h) => map.get(parseInt(h, 16)) ?? "").join("")).join("");
  return printed.filter((stream) => tables.some((map) => shown(stream, map).includes(wanted))).length;
}
