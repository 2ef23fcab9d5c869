// What goes wrong while a person takes part, in a browser: a proxy that refuses, a full disk, lost replies, a second tab, no WebGL, a
// phone, the leave dialog in a drive, half a questionnaire and a reload, taking back after the end.
//
// usage: node trouble.mjs MAVERIC FOLDER   (CHROMIUM: the browser; SHOTS: a folder for pictures)
import { execFileSync } from "node:child_process";
import { readFileSync, readdirSync } from "node:fs";
import { join } from "node:path";
import { Seat, check, end, launch, pause, picture } from "./room.mjs";

const [maveric, folder] = process.argv.slice(2);
const viewport = { width: 640, height: 480 };

// With its signal ignored, a limit on the size of files is a disk that is full; prlimit sets and lifts it.
const seat = new Seat(maveric, folder, ["bash", "-c", "trap '' XFSZ; exec \"$0\" \"$@\""]);
await seat.start();
const disk = (limit) => execFileSync("prlimit", ["--pid", String(seat.server.pid), `--fsize=${limit}:unlimited`]);

const browser = await launch();
await seat.openLab(browser, { width: 1280, height: 800 });

const has = (page, selector, text, timeout = 60000) => page.waitForFunction(([s, t]) => document.querySelector(s)?.textContent.includes(t), [selector, text], { timeout });
const heading = (page, text, timeout) => has(page, "main h1", text, timeout);
const onTheRoad = (page) => page.waitForFunction(() => !document.querySelector("#drive").hidden && /\d/.test(document.querySelector("#speed").textContent), null, { timeout: 60000 });
const offTheRoad = (page) => page.waitForFunction(() => document.querySelector("#drive").hidden, null, { timeout: 120000 });
const press = (page) => page.locator("main button.main").press("Enter");
const look = (page, name) => picture(page, `trouble-${name}`);
async function open(context, link, what = {}) {
  const page = await context.newPage();
  page.on("pageerror", (error) => check(false, `no error in the page: ${error.message}`));
  for (const [path, handler] of Object.entries(what)) await page.route(path, handler);
  await page.goto(link);
  return page;
}
async function answer(page) {
  const sets = await page.locator("form fieldset").count();
  for (let i = 0; i < sets; i++) await page.locator("form fieldset").nth(i).locator("input").nth(i % 3).check();
  await page.locator("form button").press("Enter");
}
/// The lines of drives that the browser keeps.
const lines = (page) => page.evaluate(() => new Promise((done) => {
  const opening = indexedDB.open("maveric-seat", 1);
  opening.onsuccess = () => { const all = opening.result.transaction("lines").objectStore("lines").getAll(); all.onsuccess = () => { opening.result.close(); done(all.result.length); }; };
}));
const drafts = (page) => page.evaluate(() => Object.keys(localStorage).filter((key) => key.includes("draft")).length);

async function withoutWebGl() {
  const context = await browser.newContext({ viewport });
  await context.addInitScript(() => {
    const before = HTMLCanvasElement.prototype.getContext;
    HTMLCanvasElement.prototype.getContext = function (kind, ...more) { return kind.startsWith("webgl") ? null : before.call(this, kind, ...more); };
  });
  const page = await open(context, await seat.link());
  await page.waitForSelector("main h1");
  const text = await page.locator("main").textContent();
  check(text.includes("WebGL") && !text.includes("I agree"), "without WebGL a person is told before consent");
  await look(page, "no-webgl");
  await context.close();
}

async function onAPhone() {
  const context = await browser.newContext({ viewport: { width: 390, height: 800 }, isMobile: true, hasTouch: true });
  const page = await open(context, await seat.link());
  await page.waitForSelector("main h1");
  check((await page.locator("main h1").textContent()).includes("on a computer"), "a phone is told that the study needs a computer");
  await look(page, "phone");
  await page.getByRole("button", { name: "Go on all the same" }).tap();
  await page.waitForFunction(() => document.querySelector("main").textContent.includes("I agree"));
  await page.getByRole("button", { name: "I agree" }).tap();
  await page.waitForSelector("form fieldset");
  const rows = await page.locator(".points").evaluateAll((all) => all.map((points) => new Set([...points.children].map((box) => box.getBoundingClientRect().top)).size));
  check(rows.length === 3 && rows.every((n) => n === 1), `the points of a scale stand in one row on a phone, too: ${rows}`);
  check((await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth)) === 0, "and the page is no wider than the phone");
  await look(page, "phone-sheet");
  await context.close();
}

/// Before the drives: a reload in the middle of a questionnaire, and a full disk when it is sent.
async function questionnaire(page) {
  await page.waitForSelector("main button.main");
  await page.setViewportSize({ ...viewport, height: 240 });
  await press(page);
  await page.waitForSelector("form fieldset");
  const opened = Date.now();
  const [longer, above] = await page.evaluate(() => [document.body.scrollHeight > innerHeight, scrollY]);
  check(longer && above === 0, `a page that is longer than the window begins with its first line: ${above} px are above`);
  await page.setViewportSize(viewport);
  await pause(3500);
  await page.locator("form fieldset").nth(0).locator("input").nth(4).check();
  await page.locator("form fieldset").nth(1).locator("input").nth(2).check();
  await page.reload();
  await page.waitForSelector("form fieldset");
  check((await page.locator("input:checked").count()) === 2, "half a questionnaire survives a reload");
  await page.evaluate(() => scrollTo(0, document.body.scrollHeight));
  check((await page.locator("#bar").boundingBox()).y === 0, "the header with “Leave the study” stays when a page is scrolled");
  const begun = Date.now();
  disk(0);
  const sent = page.waitForRequest("**/answer/**");
  await answer(page);
  const { seconds } = JSON.parse((await sent).postData());
  check(seconds > 3.5 && seconds <= (Date.now() - opened) / 1000 + 1, `the time before a reload counts: ${seconds} s`);
  await has(page, "#note", "Not taken in yet (500)");
  while (!/full|I\/O|kept|large|disk/i.test(seat.stderr.split("the seat is open")[1] ?? "") && Date.now() - begun < 5000) await pause(100);
  check(/answer/.test(seat.stderr.split("the seat is open")[1] ?? ""), `a full disk is told on stderr: ${(seat.stderr.split("the seat is open")[1] ?? "").trim().split("\n").at(-1)}`);
  check((await drafts(page)) === 1, "what the server could not keep stays in the browser");
  await look(page, "full-disk");
  disk("unlimited");
  await page.waitForFunction(() => document.querySelector("form fieldset") === null);
  check((await drafts(page)) === 0, "what the server keeps is deleted in the browser");
}

async function practice(page) {
  await page.waitForSelector("main button.main");
  await press(page);
  await heading(page, "Practice");
  await press(page);
  await onTheRoad(page);
  await page.keyboard.down("ArrowUp");
  await offTheRoad(page);
  await page.keyboard.up("ArrowUp");
  await page.waitForFunction(() => /^(Practice passed|The time for practice is over)$/.test(document.querySelector("main h1")?.textContent ?? ""), null, { timeout: 60000 });
  await press(page);
  await heading(page, "Your drive");
}

/// A drive that nothing of arrives, a reload, and the same with a proxy that takes small parts alone.
async function refusingProxy(context, page, link) {
  const statuses = [413, 429, 502, 503, 403, 404];
  let at = 0, seen = new Set();
  const refuses = (route) => { const status = statuses[at++ % statuses.length]; seen.add(status); return route.fulfill({ status, body: "<html>the proxy's own words</html>" }); };
  await page.route("**/drive/**", refuses);
  await press(page);
  await onTheRoad(page);
  await page.keyboard.down("ArrowUp");
  await pause(8500);
  check(await page.locator("#drive").isVisible(), `a proxy's refusals (${[...seen].join(", ")}) do not end a drive`);
  await has(page, "#note", "Not taken in yet", 5000).then(() => check(true, "whoever drives is told that it is not taken in yet"), () => check(false, "whoever drives is told that it is not taken in yet"));
  await look(page, "proxy");
  const before = await lines(page);
  await page.close();
  const again = await open(context, link, { "**/drive/**": refuses });
  await has(again, "#note", "Not taken in yet");
  await pause(2500);
  const kept = await lines(again);
  check(before >= 6 && kept >= before, `after a reload, too, the browser keeps every line that nobody acknowledged (${before}, then ${kept})`);
  await again.unroute("**/drive/**");
  // A part is too large for the proxy, single lines are not.
  await again.route("**/drive/**", (route) => route.request().postData().trim().split("\n").length > 2 ? route.fulfill({ status: 413 }) : route.continue());
  await heading(again, "Your drive");
  check((await again.locator("main").textContent()).includes("cut short"), "the drive that was cut short arrived, and begins again");
  check((await lines(again)) === 0, "acknowledged in parts, nothing is left in the browser");
  await again.unroute("**/drive/**");
  return again;
}

/// A second tab in the middle of a drive, the leave dialog, and a lost reply on its end.
async function drivenInOneTab(context, page, link) {
  await press(page);
  await onTheRoad(page);
  await page.keyboard.down("ArrowUp");
  await pause(2000);
  const second = await open(context, link);
  await heading(second, "This cannot go on");
  check((await second.locator("main").textContent()).includes("another tab"), "a second tab is told that the study is open in another, and drives nothing");
  await look(second, "second-tab");
  await second.close();
  await page.bringToFront();
  await page.getByRole("button", { name: "Leave the study" }).click();
  await page.waitForSelector("dialog[open]");
  check((await page.getByRole("dialog", { name: "Leave the study?" }).count()) === 1, "the dialog is called by its question");
  check((await page.evaluate(() => document.activeElement?.textContent)) === "Stay", "a second Enter on “Leave the study” stays");
  await look(page, "leave-in-a-drive");
  await pause(1500);
  await page.getByRole("button", { name: "Stay" }).click();
  // The reply on its end is lost: it is asked for again.
  let lost = 0;
  await page.route("**/done/**", async (route) => { if (lost++ > 0) return route.continue(); await route.fetch(); return route.abort(); });
  await page.keyboard.down("ArrowUp");
  await offTheRoad(page);
  await page.keyboard.up("ArrowUp");
  await page.waitForFunction(() => document.querySelector("main h1").textContent !== "Your drive");
  check(lost > 1, "a lost reply on a drive's end is asked for again");
  await page.unroute("**/done/**");
  const records = readdirSync(join(folder, "seat")).filter((f) => f.includes("-own") && f.endsWith(".jsonl"));
  const cut = records.find((f) => f.includes("cut1")), whole = records.find((f) => !f.includes("cut"));
  const events = (f) => readFileSync(join(folder, "seat", f), "utf8");
  const ticks = (f) => events(f).split("\n").filter((l) => l.includes("from_tick")).reduce((sum, l) => sum + JSON.parse(l).ticks, 0);
  check(cut && ticks(cut) > 500, `the drive that met the proxy is kept whole: ${cut && ticks(cut)} steps`);
  check(whole && /paused: asked whether to leave/.test(events(whole)) && /goes on after \d{4} ms/.test(events(whole)), "the record says that the leave dialog paused the world, and how long");
  check(whole && execFileSync(maveric, ["seat", "replay", join(folder, "seat", whole)], { encoding: "utf8" }).includes("to the byte"), "a drive with a pause replays to the byte");
}

/// The rest without a word; the last replies are lost; then what was given is taken back.
async function theEnd(context, page, link) {
  for (let guard = 0; guard < 20; guard++) {
    await page.waitForFunction(() => document.querySelector("#drive").hidden && (document.querySelector("form fieldset") || document.querySelector("main button.main:not(:disabled)") || document.querySelector("main h1")?.textContent === "Thank you"), null, { timeout: 120000 });
    const title = await page.locator("main h1").first().textContent();
    if (title === "Thank you") break;
    if ((await page.locator("form fieldset").count()) > 0) {
      const drop = async (route) => { await route.fetch(); await route.abort(); };
      // The last answer, and whatever is asked after it, get no reply.
      const last = await page.evaluate(async () => { const s = await (await fetch(`/api/${location.pathname.split("/").pop()}`)).json(); return s.at === s.steps.length - 2; });
      if (last) { await page.route("**/answer/**", drop); await page.route("**/done/**", drop); }
      await answer(page);
      if (last) {
        await has(page, "#note", "No connection");
        await page.close();
        page = await open(context, link, { "**/done/**": drop });
        await page.waitForTimeout(1500);
        await page.close();
        page = await open(context, link);
      } else await page.waitForFunction(() => document.querySelector("form fieldset") === null);
    } else {
      await press(page);
      await page.waitForFunction((before) => !document.querySelector("#drive").hidden || document.querySelector("main h1")?.textContent !== before, title);
    }
  }
  check((await page.locator("main").textContent()).includes("C1X9"), "whoever lost the last replies is shown the code all the same");
  await look(page, "thank-you");
  const answers = () => readFileSync(join(folder, "surveys/answers.csv"), "utf8").includes("P003");
  check(answers(), "their answers are in the study's table");
  await page.getByRole("button", { name: "Delete what I gave" }).click();
  check((await page.locator("dialog").textContent()).includes("cannot be called back"), "whoever takes back is told what no deletion calls back");
  await look(page, "take-back");
  await page.route("**/leave", (route) => route.fulfill({ status: 403, headers: { "maveric-refused": "too-late" }, body: "what was given in this study could be taken back until 2026-01-01" }));
  await page.getByRole("button", { name: "Delete it" }).click();
  await has(page, "dialog [role=alert]", "can no longer be taken back", 10000).then(() => check(true, "a deletion that comes too late is refused in words"), () => check(false, "a deletion that comes too late is refused in words"));
  await page.unroute("**/leave");
  await page.getByRole("button", { name: "Keep it" }).click();
  await page.evaluate((token) => localStorage.setItem(`maveric-seat-draft ${token} 1`, "[1]"), link.split("/").pop());
  await page.getByRole("button", { name: "Delete what I gave" }).click();
  await page.getByRole("button", { name: "Delete it" }).click();
  await has(page, "main", "What you gave was deleted.", 20000);
  await pause(300);
  check((await lines(page)) === 0 && (await drafts(page)) === 0, "nothing of somebody who is forgotten stays in the browser");
  check(!answers(), "their answers are gone");
  await look(page, "deleted");
}

await withoutWebGl();
await onAPhone();
const context = await browser.newContext({ viewport });
const link = await seat.link();
let page = await open(context, link);
await questionnaire(page);
await practice(page);
page = await refusingProxy(context, page, link);
await drivenInOneTab(context, page, link);
await theEnd(context, page, link);
await browser.close();
end();
