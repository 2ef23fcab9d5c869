// A drive by hand, and a ride that shows it again: the same states, without a model.
//
// usage: node shown.mjs MAVERIC FOLDER   (CHROMIUM: the browser; SHOTS: a folder for pictures)
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { Seat, check, end, launch, pause, picture } from "./room.mjs";

const [maveric, folder] = process.argv.slice(2);
const viewport = { width: 1000, height: 700 };
const seat = new Seat(maveric, folder);
await seat.start();
const browser = await launch();
await seat.openLab(browser, viewport);
const page = await (await browser.newContext({ viewport })).newPage();
page.on("pageerror", (error) => check(false, `no error in the page: ${error.message}`));
await page.goto(await seat.link());
const heading = (text) => page.waitForFunction((t) => document.querySelector("#drive").hidden && document.querySelector("main h1")?.textContent.includes(t), text, { timeout: 60000 });
const press = () => page.locator("main button.main").press("Enter");
await heading("How do you want to drive");
await press();
await heading("Your drive");
await press();
await page.waitForSelector("#drive:not([hidden])");
await page.keyboard.down("ArrowUp");
await pause(4000);
await page.keyboard.down("ArrowLeft");
await pause(300);
await page.keyboard.up("ArrowLeft");
await heading("Ride 1");
await page.keyboard.up("ArrowUp");
await press();
await page.waitForSelector("#drive:not([hidden])");
await pause(3000);
await page.keyboard.press("u");
await picture(page, "shown-ride");
await heading("What this study was about");
await press();
await heading("Thank you");
await browser.close();
await seat.stop("SIGINT");
const record = (name) => join(folder, `seat/P001-${name}.jsonl`);
const lines = (name) => readFileSync(record(name), "utf8").trim().split("\n").map((line) => JSON.parse(line));
const [own, again] = [lines("own"), lines("again")];
check(again.at(-1).states === own.at(-1).states, "the ride went through the states of the drive");
check(again[0].driven_by === "automated" && again.some((line) => line.events?.some((event) => event.what === "uncomfortable")), "it is a ride in which one can press");
for (const name of ["own", "again"]) {
  const told = execFileSync(maveric, ["seat", "replay", record(name)], { encoding: "utf8" }).trim();
  check(told.includes("the same states, to the byte"), `replay of ${name}: ${told}`);
}
end();
