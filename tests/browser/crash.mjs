// A rest before a drive, and a drive into a car that stands: the button of the rest waits, and the drive ends with what the study says of a crash.
//
// usage: node crash.mjs MAVERIC FOLDER   (CHROMIUM: the browser; SHOTS: a folder for pictures)
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { Seat, check, end, launch, picture } from "./room.mjs";

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
await page.waitForSelector("main button.main");
check((await page.locator("main").textContent()).includes("you will hear it"), "the consent names the crash");
await press();
await heading("A break");
check(await page.locator("main button.main").isDisabled(), "nobody goes on before the rest was long enough");
await picture(page, "crash-break");
await page.waitForSelector("main button.main:not(:disabled)");
await press();
await heading("How do you want to drive");
await press();
await heading("Your drive");
await press();
await page.waitForFunction(() => document.querySelector("#drive").classList.contains("felt"), null, { timeout: 60000 });
check(true, "the crash is felt");
await picture(page, "crash-felt");
await heading("This drive is over");
await picture(page, "crash-over");
await press();
await heading("Thank you");
const record = join(folder, "seat/P001-own.jsonl");
check(readFileSync(record, "utf8").includes('"what":"crash"'), "the record says that it ended with a crash");
const told = execFileSync(maveric, ["seat", "replay", record], { encoding: "utf8" }).trim();
check(told.includes("the same states, to the byte"), `replay of a drive that ended with a crash: ${told}`);
await seat.lab.goto(`${seat.base}/lab`);
check(/The disk has [\d.]+ GB left/.test(await seat.lab.locator("#disk").textContent()), "the laboratory says what the disk has left");
check((await seat.lab.locator("main").textContent()).includes("hit another vehicle"), "and that the car hit another");
await picture(seat.lab, "crash-lab");
await browser.close();
await seat.stop("SIGINT");
end();
