// Drives in Node what it is told on standard input, with the WebAssembly of the committed page, and says what became of it.
import { readFileSync } from "node:fs";

const built = new URL("../../seat/page/built/", import.meta.url);
const { initSync, PageModel, PageDrive, replay } = await import(new URL("seat.js", built));
initSync({ module: readFileSync(new URL("seat.wasm", built)) });
const told = JSON.parse(readFileSync(0, "utf8"));

const drive = PageDrive.by_hand(told.scenario, told.seconds, told.seed, "scripted");
const lines = [drive.header()];
let goesOn = true;
for (const [keys, signal, steps] of told.pressed) {
  goesOn = drive.keys(keys, signal, steps);
  lines.push(drive.chunk(new Uint32Array(5)));
}
if (goesOn) throw new Error("the drive goes on");
const driven = drive.finish();
lines.push(driven.end());
const fit = driven.fit(new PageModel(Uint8Array.from(Buffer.from(told.model, "base64"))));
const again = told.records.map((record) => JSON.parse(replay(record)));
console.log(JSON.stringify({ record: lines.map((l) => l + "\n").join(""), fit: JSON.parse(fit), again }));
