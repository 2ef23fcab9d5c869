// An experimenter with four people on a road of bends, who does each thing once: an id and an order by hand, a drive that is made longer,
// one that is driven again, a step that is skipped, an end of the driving, a person left out, one who never came, one who is forgotten.
//
// usage: node experimenter.mjs MAVERIC FOLDER   (CHROMIUM: the browser; SHOTS: a folder for pictures)
import { execFileSync } from "node:child_process";
import { existsSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { Seat, check, end, launch, pause, picture } from "./room.mjs";

const [maveric, folder] = process.argv.slice(2);
const viewport = { width: 640, height: 480 };
const browser = await launch();
const seat = new Seat(maveric, folder);
await seat.start();
await seat.openLab(browser, { width: 1280, height: 800 });
const { lab } = seat;
const row = (id) => lab.locator(`#person-${id}`);
const read = (name) => readFileSync(join(folder, name), "utf8");

/// Somebody new, as the experimenter says.
async function comes({ id = "", order = "" } = {}) {
  await lab.goto(`${seat.base}/lab`);
  await lab.locator("input[name=participant]").fill(id);
  await lab.locator("input[name=order]").fill(order);
  await lab.locator("form[action='/lab/next'] button").press("Enter");
  await lab.waitForLoadState();
  const link = new URL(await lab.locator("a[href^='/p/']").last().getAttribute("href"), seat.base).href;
  const page = await (await browser.newContext({ viewport })).newPage();
  page.on("pageerror", (error) => check(false, `no error in the page: ${error.message}`));
  return { link, page };
}

/// Does something with the step at which somebody is.
async function acts(id, act, reason, minutes) {
  await lab.goto(`${seat.base}/lab`);
  await row(id).getByText("Step …").click();
  await lab.waitForLoadState();
  // Enter in a field does what stands beside it.
  const form = lab.locator("form", { has: lab.locator(`input[value=${act}]`) });
  await form.locator("input[name=reason]").fill(reason);
  if (minutes) await form.locator("input[name=minutes]").fill(String(minutes));
  await form.locator(minutes ? "input[name=minutes]" : "input[name=reason]").press("Enter");
  await lab.waitForLoadState();
  check(lab.url().endsWith("/lab"), `${act} is done: ${await lab.locator("h1").first().textContent()}`);
}

const heading = (page, text) => page.waitForFunction((t) => document.querySelector("#drive").hidden && document.querySelector("main h1")?.textContent.includes(t), text, { timeout: 90000 });
const press = (page) => page.locator("main button.main").press("Enter");
const onTheRoad = (page) => page.waitForFunction(() => !document.querySelector("#drive").hidden && /\d/.test(document.querySelector("#speed").textContent), null, { timeout: 60000 });
async function toDrive({ link, page }) {
  await page.goto(link);
  await heading(page, "The experimenter");
  await press(page);
  await heading(page, "How do you want to drive");
  await press(page);
  await heading(page, "Your drive");
}
async function drives(page) {
  await press(page);
  await onTheRoad(page);
}
async function answers(page) {
  await page.waitForSelector("form fieldset");
  await page.locator("form fieldset input").first().check();
  const form = await page.locator("form").elementHandle();
  await page.locator("form button").press("Enter");
  await page.waitForFunction((gone) => !gone.isConnected, form);
}

// An id and an order by hand; refused where they cannot be.
const first = await comes({ id: "LAB7", order: "sporty calm" });
check((await row("LAB7").textContent()).includes("sporty, calm"), "an id and an order by hand stand in the table");
await lab.locator("input[name=participant]").fill("lab7");
await lab.locator("form[action='/lab/next'] button").press("Enter");
await lab.waitForLoadState();
check((await lab.locator("body").textContent()).includes("stands already"), "an id that stands already is refused");
await lab.goto(`${seat.base}/lab`);
await lab.locator("input[name=order]").fill("calm calm");
await lab.locator("form[action='/lab/next'] button").press("Enter");
await lab.waitForLoadState();
check((await lab.locator("body").textContent()).includes("stands twice"), "an order with a condition twice is refused");

// A drive that is driven again, then the rides elsewhere: the first is skipped.
await toDrive(first);
await drives(first.page);
await heading(first.page, "Ride 1");
await acts("LAB7", "repeat", "the wheel came loose");
await first.page.reload();
await heading(first.page, "Your drive");
await drives(first.page);
await pause(3000);
await lab.goto(`${seat.base}/lab`);
check(/\d/.test(await row("LAB7").locator("td").nth(3).textContent()), "pictures a second of a drive that goes on stand on the page");
await picture(lab, "experimenter-0-lab");
await row("LAB7").locator("a").first().click();
await lab.waitForLoadState();
await picture(lab, "experimenter-1-above");
await heading(first.page, "Ride 1");
await acts("LAB7", "skip", "the rig was not ready");
await first.page.reload();
await heading(first.page, "Ride 2");
await press(first.page);
await answers(first.page);
await heading(first.page, "Thank you");

// A drive that is made longer, and whose driving is ended.
const second = await comes();
check((await row("P002").textContent()).includes("calm, sporty"), "the next has the square's order");
await toDrive(second);
await acts("P002", "extend", "the lead was late", 1);
await lab.goto(`${seat.base}/lab/step/P002/2`);
await picture(lab, "experimenter-2-step");
await second.page.reload();
await drives(second.page);
await pause(2000);
await lab.goto(`${seat.base}/lab`);
check((await row("P002").textContent()).includes("of 70 s"), "a minute more is driven");
await acts("P002", "abort", "a fire alarm");
await heading(second.page, "ends here");
await picture(second.page, "experimenter-3-aborted");
await press(second.page);
await heading(second.page, "Thank you");

// Somebody who is left out, by a reason, and goes on.
const third = await comes();
await toDrive(third);
await lab.goto(`${seat.base}/lab`);
await row("P003").getByText("Leave out …").click();
await lab.locator("input[name=reason]").fill("wore no glasses");
await picture(lab, "experimenter-4-exclude");
await lab.locator("form button").press("Enter");
await lab.waitForLoadState();
check((await row("P003").textContent()).includes("Left out"), "whoever is left out is marked");
await drives(third.page);
for (const number of [1, 2]) { await heading(third.page, `Ride ${number}`); await press(third.page); await answers(third.page); }
await heading(third.page, "Thank you");

// One who never came, and one who is forgotten.
await comes();
await row("P004").getByText("Never came").click();
await lab.waitForLoadState();
check((await row("P004").textContent()).includes("never came"), "whoever never came is said to");
await row("P003").getByText("Forget …").click();
await lab.waitForLoadState();
const forgotten = "P003";
await lab.goto(`${seat.base}/lab`);
await lab.locator("input[name=note]").fill("everything was done once");
await lab.locator("form[action='/lab/note'] button").press("Enter");
await lab.waitForLoadState();
await picture(lab, "experimenter-5-lab");
const stopped = read("seat/stopped.csv");
check(/LAB7,sporty,0\.0,skipped: the rig was not ready/.test(stopped), "a ride that was skipped is left out by name, and nobody is asked about it");
check(/P003,calm,0\.0,excluded: wore no glasses/.test(stopped), "and so is a ride elsewhere of somebody who is left out");
check(/P002,own,[\d.]+,aborted: a fire alarm/.test(stopped), "what was ended stands in its table");
check(/P003,own,[\d.]+,excluded: wore no glasses/.test(stopped), "and whoever is left out");
check(existsSync(join(folder, "seat/LAB7-own.repeated1.jsonl")), "what was driven before stands beside what counts");
const events = read("seat/events.csv");
for (const what of ["repeated: the wheel came loose", "extended by 1 min: the lead was late"]) check(events.includes(what), `${what} is an event`);
for (const record of ["LAB7-own", "P002-own", "P003-own"]) {
  const told = execFileSync(maveric, ["seat", "replay", join(folder, `seat/${record}.jsonl`)], { encoding: "utf8" }).trim();
  check(told.includes(record === "P002-own" ? "cut short" : "to the byte"), `${record}: ${told}`);
}
await lab.goto(`${seat.base}/lab/forget/${forgotten}`);
await lab.locator("form button").press("Enter");
await lab.waitForLoadState();
check(!existsSync(join(folder, "seat/P003-own.jsonl")) && !read("surveys/answers.csv").includes("P003"), "whoever is forgotten is in no file");
await seat.stop("SIGINT");
check(read("seat/notes.csv").includes("everything was done once"), "a note is kept");
await browser.close();
end();
