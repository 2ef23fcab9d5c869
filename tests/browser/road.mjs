// The seat's own road: whoever lets go of the keys leaves the lane and has practised nothing, whoever steers has; and how many pictures a
// second the bends cost, against the straight road, in one run.
//
// usage: node road.mjs MAVERIC FOLDER STRAIGHT   (two studies that differ by their road; CHROMIUM: the browser; SIZE: of the window, 1280x800; SHOTS: a folder for pictures)
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { Seat, check, end, launch, pause, picture } from "./room.mjs";

const [maveric, bends, straight] = process.argv.slice(2);
const [width, height] = (process.env.SIZE ?? "1280x800").split("x").map(Number);
const viewport = { width, height };
const browser = await launch();
const heading = (page, text) => page.waitForFunction((t) => document.querySelector("#drive").hidden && document.querySelector("main h1")?.textContent.includes(t), text, { timeout: 60000 });
const onTheRoad = (page) => page.waitForFunction(() => !document.querySelector("#drive").hidden && /\d/.test(document.querySelector("#speed").textContent), null, { timeout: 60000 });
const offTheRoad = (page) => page.waitForFunction(() => document.querySelector("#drive").hidden, null, { timeout: 120000 });
const press = (page) => page.locator("main button.main").press("Enter");

/// Somebody who practises, touching the steering to and fro or not at all, and drives hands off: what they read after practice, and pictures a second of the drive.
async function drives(seat, id, { steers, looked }) {
  const page = await (await browser.newContext({ viewport })).newPage();
  page.on("pageerror", (error) => check(false, `no error in the page: ${error.message}`));
  await page.goto(await seat.link());
  await heading(page, "How do you want to drive");
  await press(page);
  await heading(page, "Practice");
  await press(page);
  await onTheRoad(page);
  // To and fro: how long a key is held is not sure to the hundredth of a second.
  for (let i = 0; steers && (await page.locator("#drive").isVisible()); i++) { await pause(500); await page.keyboard.press(i % 2 ? "ArrowRight" : "ArrowLeft", { delay: 40 }); }
  await page.waitForFunction(() => /^(Practice passed|The time for practice is over)$/.test(document.querySelector("main h1")?.textContent ?? ""), null, { timeout: 60000 });
  const practised = await page.locator("main h1").textContent();
  await press(page);
  await heading(page, "Your drive");
  await press(page);
  await onTheRoad(page);
  if (looked) for (const [i, ms] of [700, 2600, 2700].entries()) { await pause(ms); await picture(page, `road-${looked}-${i}`); }
  await offTheRoad(page);
  await page.waitForFunction(() => document.querySelector("main h1").textContent === "Thank you", null, { timeout: 60000 });
  await page.context().close();
  const chunks = readFileSync(join(seat.folder, "seat", `${id}-own.jsonl`), "utf8").split("\n").filter((l) => l.includes('"frames"')).map((l) => JSON.parse(l));
  const sum = (of) => chunks.reduce((n, chunk) => n + of(chunk), 0);
  return { practised, rate: sum((c) => c.frames.drawn) / (sum((c) => c.ticks) / 100) };
}

const rates = { bends: [], straight: [] };
for (const [name, folder] of [["straight", straight], ["bends", bends]]) {
  const seat = new Seat(maveric, folder);
  seat.folder = folder;
  await seat.start();
  await seat.openLab(browser, viewport);
  const off = await drives(seat, "P001", { steers: false, looked: name });
  check(off.practised === "The time for practice is over", `nobody passes practice by doing nothing on the ${name}: ${off.practised}`);
  const by = await drives(seat, "P002", { steers: true });
  check(by.practised === "Practice passed", `who steers and keeps the lane passes practice on the ${name}: ${by.practised}`);
  rates[name].push(off.rate, by.rate);
  await seat.stop("SIGINT");
}
await browser.close();
const mean = (all) => all.reduce((a, b) => a + b, 0) / all.length;
console.log(`  ${mean(rates.bends).toFixed(1)} pictures a second in the bends, ${mean(rates.straight).toFixed(1)} on the straight road: ${(mean(rates.bends) / mean(rates.straight)).toFixed(2)} of them`);
end();
