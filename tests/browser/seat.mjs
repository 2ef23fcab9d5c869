// Scripted people at the keyboard go through a whole study in a browser: one looked at on the way, one meanwhile, and one to whom in
// every step the tab is closed, the network cut and the server killed. Then `maveric run` makes the study's page of what was written.
//
// usage: node seat.mjs MAVERIC FOLDER   (CHROMIUM: the browser; SHOTS: a folder for pictures of each step)
import { execFileSync } from "node:child_process";
import { readFileSync, existsSync, readdirSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";
import { Seat, check, end, launch, pause, shots } from "./room.mjs";

const [maveric, folder] = process.argv.slice(2);
const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
const sizes = [{ width: 1280, height: 800 }, { width: 1920, height: 1080 }];
const small = { width: 480, height: 360 };
const seat = new Seat(maveric, folder);
const { base } = seat;
await seat.start();
const browser = await launch();
await seat.openLab(browser, sizes[0], (page) => axed(page, "the laboratory's door"));
const { lab } = seat;

let shot = 0;
async function look(page, name) {
  if (!shots) return;
  for (const size of sizes) {
    await page.setViewportSize(size);
    await pause(400);
    await page.screenshot({ path: join(shots, `${String(shot).padStart(2, "0")}-${name}-${size.width}.png`) });
  }
  await page.setViewportSize(sizes[0]);
  shot++;
}
async function axed(page, name) {
  await page.evaluate(axe);
  const found = await page.evaluate(async () => (await globalThis.axe.run()).violations.map((v) => `${v.id}: ${v.nodes[0]?.html}`));
  check(found.length === 0, `axe on ${name}: ${found.join("; ") || "nothing"}`);
}

/// Somebody in a browser of their own.
class Somebody {
  constructor(context, link, tell) { Object.assign(this, { context, link, tell, seen: new Set() }); }

  async open() {
    this.page = await this.context.newPage();
    this.page.on("pageerror", (error) => check(false, `no error in the page: ${error.message}`));
    this.page.on("console", (message) => { if (message.type() === "error" && !message.text().includes("Failed to load resource")) check(false, `no error on the console: ${message.text()}`); });
    const begun = Date.now();
    await this.page.goto(this.link);
    await this.words();
    if (this.tell) console.log(`  the first page ${Date.now() - begun} ms after the link is opened`);
  }
  heading() { return this.page.locator("main h1").first().textContent(); }
  driving() { return this.page.locator("#drive").isVisible(); }
  words() { return this.page.waitForFunction(() => document.querySelector("#drive").hidden && document.querySelector("main h1") !== null, null, { timeout: 120000 }); }
  gone(title) {
    return this.page.waitForFunction((before) => !document.querySelector("#drive").hidden || document.querySelector("main h1")?.textContent !== before, title, { timeout: 60000 });
  }

  /// Presses Enter on the button that leads on, found as a keyboard finds it.
  async pressMain() {
    for (let i = 0; i < 60; i++) {
      await this.page.keyboard.press("Tab");
      if (await this.page.evaluate(() => document.activeElement?.classList.contains("main"))) return this.page.keyboard.press("Enter");
    }
    throw new Error(`no button to press on: ${await this.heading()}`);
  }

  /// Answers every item of the scale that is asked, and sends it.
  async answer(fresh) {
    const page = this.page;
    if (fresh) {
      check((await page.locator("input:checked").count()) === 0, "nothing is preselected");
      await page.locator("form button").press("Enter");
      check((await page.locator("[role=alert]").textContent()).startsWith("Not answered yet"), "missing answers are asked for once");
    }
    const sets = await page.locator("form fieldset").count();
    for (let i = 0; i < sets; i++) {
      await page.locator("form fieldset").nth(i).locator("input").first().focus();
      for (let k = 0; k <= i % 3; k++) await page.keyboard.press("ArrowRight");
    }
    await page.locator("form button").press("Enter");
  }

  /// Waits for the first picture of a drive that begins, whose speed is shown with it.
  async pictured() {
    const begun = Date.now();
    await this.page.waitForFunction(() => /\d/.test(document.querySelector("#speed").textContent), null, { timeout: 60000 });
    console.log(`  a picture ${Date.now() - begun} ms after Begin is pressed`);
  }

  /// One step after the other; `upset` comes between where it is given.
  async goThrough(upset) {
    for (let guard = 0; guard < 60; guard++) {
      await this.words();
      const title = await this.heading();
      const fresh = this.tell && !this.seen.has(title);
      this.seen.add(title);
      if (fresh) { await look(this.page, title.toLowerCase().replaceAll(/[^a-z0-9]+/g, "-")); await axed(this.page, title); }
      if (title === "Thank you") return;
      const asked = (await this.page.locator("form fieldset").count()) > 0;
      const drives = /^(Practice|Your drive|Ride \d+)$/.test(title);
      // Told once, and no step.
      const passing = /^(Practice passed|The time for practice is over)$/.test(title);
      if (upset && !drives && !passing) {
        // The tab is closed; then the network goes, the step is done, the server goes and comes back, and the network too.
        await this.page.close();
        await this.open();
        await this.words();
        check((await this.heading()) === title, `after a closed tab it goes on at “${title}”`);
        await this.context.setOffline(true);
        await (asked ? this.answer(false) : this.pressMain());
        if (!/^How do you/.test(title)) await this.page.waitForFunction(() => document.querySelector("#note").textContent.startsWith("No connection"), null, { timeout: 20000 });
        await seat.stop("SIGKILL");
        await seat.start();
        await this.context.setOffline(false);
      } else if (asked) await this.answer(fresh);
      else await this.pressMain();
      if (fresh && drives) await this.pictured();
      if (drives) await this.drive(title, fresh, upset);
      // Two scales in a row may have one title: that the first is gone shows by what is asked of the server.
      await this.gone(title).catch(() => {});
    }
    throw new Error("the study does not end");
  }

  async drive(title, fresh, upset) {
    const page = () => this.page, byHand = !title.startsWith("Ride");
    await this.page.waitForFunction(() => !document.querySelector("#drive").hidden);
    if (byHand) await page().keyboard.down("ArrowUp");
    if (upset) {
      await pause(2000);
      await this.context.setOffline(true);
      await pause(2000);
      await this.context.setOffline(false);
      await seat.stop("SIGKILL");
      await pause(1000);
      await seat.start();
      await pause(1500);
      // A practice may be over by now.
      if (await this.driving()) {
        await page().close();
        await this.open();
        await this.words();
        check((await page().locator("main").textContent()).includes("cut short"), `“${title}”, cut short by a closed tab, begins again`);
        await this.pressMain();
        await page().waitForFunction(() => !document.querySelector("#drive").hidden);
        if (byHand) await page().keyboard.down("ArrowUp");
        // The network is gone when the drive ends.
        await this.context.setOffline(true);
        await page().waitForFunction(() => document.querySelector("#drive").hidden, null, { timeout: 120000 });
        await pause(1500);
        await this.context.setOffline(false);
      }
    } else {
      await pause(4000);
      if (fresh) { await look(page(), `${byHand ? "driving" : "riding"}-${title.toLowerCase().replaceAll(" ", "-")}`); await axed(page(), `${title}, on the road`); }
      if (!byHand) await page().keyboard.press("u");
      if (byHand && fresh && title === "Your drive") { await page().keyboard.press("q"); await page().keyboard.down("ArrowLeft"); await pause(500); await page().keyboard.up("ArrowLeft"); }
    }
    await page().waitForFunction(() => document.querySelector("#drive").hidden, null, { timeout: 120000 });
    if (byHand) await page().keyboard.up("ArrowUp");
  }
}
async function somebody(viewport, tell) {
  const context = await browser.newContext({ viewport });
  const who = new Somebody(context, await seat.link(), tell);
  await who.open();
  return who;
}

const [first, other] = [await somebody(sizes[0], true), await somebody(small, false)];
await Promise.all([first.goThrough(), other.goThrough()]);
check((await first.page.locator("main").textContent()).includes("C1X9"), "the code is shown at the end");
await first.context.close();
await other.context.close();
const third = await somebody(small, false);
await third.goThrough(true);
await lab.goto(`${base}/lab`);
await axed(lab, "the laboratory");
await look(lab, "laboratory");
const happened = await lab.locator("main").textContent();
check(!happened.includes("other states") && !happened.includes("another style") && !happened.includes("cannot be driven"), "page and server agree about every drive");
check((await seat.stop("SIGINT")) === 0, "Ctrl-C ends the server in order");
await browser.close();
const records = readdirSync(join(folder, "seat")).filter((f) => f.endsWith(".jsonl")).sort();
check(["own", "calm", "sporty"].every((c) => records.includes(`P003-${c}.cut1.jsonl`)), "the drives that were cut short are kept");
for (const name of records) {
  const record = join(folder, "seat", name);
  const said = execFileSync(maveric, ["seat", "replay", record], { encoding: "utf8" }).trim();
  const by = name.includes("-own") ? "scripted" : "automated";
  check(said.startsWith(by) && said.includes(name.includes("cut") ? "cut short" : "the same states, to the byte"), `replay of ${name}: ${said}`);
  const frames = readFileSync(record, "utf8").split("\n").filter((l) => l.includes('"frames"')).map((l) => JSON.parse(l));
  const sum = (key) => frames.reduce((n, c) => n + c.frames[key], 0), most = (key) => Math.max(...frames.map((c) => c.frames[key]));
  const ticks = frames.reduce((n, c) => n + c.ticks, 0);
  console.log(`  ${(sum("drawn") / (ticks / 100)).toFixed(1)} pictures a second driven, ${sum("late")} of ${sum("drawn")} late, longest ${most("longest_ms")} ms, a key seen after at most ${most("input_ms")} ms, ${sum("dropped_steps")} of ${ticks} steps left out`);
}
const answers = readFileSync(join(folder, "surveys/answers.csv"), "utf8").trim().split("\n");
check(answers.length === 1 + 3 * 3 * 3, `every answer of three people is there, once: ${answers.length - 1}`);
const log = execFileSync(maveric, ["run"], { cwd: folder, encoding: "utf8", stdio: ["ignore", "pipe", "pipe"] });
check(existsSync(join(folder, "report", "index.html")), `maveric run ends with the study's page: ${log.trim().split("\n").at(-1)}`);
end();
