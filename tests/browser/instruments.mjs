// A study with every kind of sheet, in German, gone through by scripted people: one answers all of it and is looked at, one is too young, one
// misses the attention check, one feels sick in a ride, one leaves, one takes everything back after the debriefing; in one of the rides the car
// has somebody else's style, and one lets theirs be lent. Then `maveric run`, and its page says so.
//
// usage: node instruments.mjs MAVERIC FOLDER   (CHROMIUM: the browser; SHOTS: a folder for pictures of each step)

import { execFileSync } from "node:child_process";
import { existsSync, readFileSync, readdirSync } from "node:fs";
import { join } from "node:path";
import { Seat, check, end, launch, pause, picture } from "./room.mjs";

const [maveric, folder] = process.argv.slice(2);
const seat = new Seat(maveric, folder);
await seat.start();
const browser = await launch();
await seat.openLab(browser, { width: 1280, height: 800 });

/// The highest answer to the question of a ride.
const HIGHEST = 10;

/// Somebody with a browser of their own; `answers` gives what they answer to an item of a sheet, by the sheet's place and the item's.
class Somebody {
  constructor(link, { size = { width: 480, height: 360 }, looked = false, age = 34, attention = 2, probe = 1, lends = false, leavesAt = null } = {}) { Object.assign(this, { link, size, looked, age, attention, probe, lends, leavesAt, at: 0 }); }

  async open() {
    this.page = await (await browser.newContext({ viewport: this.size })).newPage();
    this.page.on("pageerror", (error) => check(false, `no error in the page: ${error.message}`));
    await this.page.goto(this.link);
    await this.needs();
  }
  /// What is before them: its heading, and whether it is the end.
  async before() {
    const seen = await this.page.waitForFunction(() => {
      const main = document.querySelector("main");
      if (!document.querySelector("#drive").hidden) return null;
      if (main.querySelector("form fieldset")) return { kind: "sheet" };
      const title = main.querySelector("h1")?.textContent ?? "";
      if (title && main.querySelector("button.main:not(:disabled)")) return { kind: "page", title };
      return document.querySelector("#leave").hidden && title ? { kind: "end", title } : null;
    }, null, { timeout: 120000 });
    return seen.jsonValue();
  }
  async look(name) {
    if (this.looked) await picture(this.page, `instruments-${String(this.at++).padStart(2, "0")}-${name}`);
  }

  /// Answers every item by the keys that a person has for its kind.
  async answer() {
    const sets = this.page.locator("form fieldset");
    const kinds = await sets.evaluateAll((all) => all.map((set) => {
      const input = set.querySelector("input, textarea");
      const words = set.querySelector("legend")?.textContent ?? "";
      return { kind: input.tagName === "TEXTAREA" ? "text" : input.type, words };
    }));
    for (const [i, { kind, words }] of kinds.entries()) {
      const set = sets.nth(i);
      if (kind === "text") await set.locator("textarea").fill("Wie man gerne gefahren wird");
      else if (kind === "number") await set.locator("input").fill(String(/Jahren/.test(words) ? this.age : /Führerschein/.test(words) ? 2010 : 12000));
      else if (kind === "range") { await set.locator("input").focus(); await this.page.keyboard.press("ArrowRight"); await this.page.keyboard.press("ArrowRight"); }
      else if (/wählen Sie hier/.test(words)) await set.locator("input").nth(this.attention - 1).check();
      else await set.locator("input").nth(i % Math.min(3, await set.locator("input").count())).check();
    }
    await this.look("sheet");
    const first = await sets.first().elementHandle();
    await this.page.locator("form button").press("Enter");
    await this.page.waitForFunction((gone) => !gone.isConnected, first);
  }

  /// On the road until it is over; a question that comes is answered by the digits of its number.
  async road(title) {
    await this.page.waitForFunction(() => !document.querySelector("#drive").hidden, null, { timeout: 60000 });
    const byHand = !title.startsWith("Mitfahrt");
    if (byHand) await this.page.keyboard.down("ArrowUp");
    let looked = false;
    while (await this.page.locator("#drive").isVisible()) {
      if (await this.page.locator("#question").isVisible()) {
        const buttons = this.page.locator("#probe button");
        if (!looked && !byHand) { looked = true; this.probed = await buttons.allTextContents(); await this.look("probe"); }
        for (const digit of String(byHand ? 1 : this.probe)) await this.page.keyboard.press(`Digit${digit}`);
      }
      await pause(250);
    }
    if (byHand) await this.page.keyboard.up("ArrowUp");
  }

  async goThrough() {
    await this.open();
    for (let guard = 0; guard < 80; guard++) {
      const { kind, title } = await this.before();
      if (kind === "sheet") { await this.answer(); continue; }
      await this.look(kind === "end" ? "end" : "page");
      if (kind === "end") return;
      if (title === this.leavesAt) {
        await this.page.getByRole("button", { name: "Studie verlassen" }).click();
        await this.page.getByRole("button", { name: "darf behalten werden" }).click();
        await this.page.waitForFunction(() => document.querySelector("#leave").hidden);
        return;
      }
      const box = this.page.locator("main input[type=checkbox]");
      if (this.lends && (await box.count()) === 1) await box.check();
      const drives = /^(Übungsfahrt|Ihre Fahrt|Mitfahrt \d+)$/.test(title);
      const shown = await this.page.locator("main h1").first().elementHandle();
      this.read = `${this.read ?? ""}\n${await this.page.locator("main").textContent()}`;
      await this.page.locator("main button.main").press("Enter");
      if (drives) await this.road(title);
      await this.page.waitForFunction((gone) => !gone.isConnected || !document.querySelector("#drive").hidden, shown);
    }
    throw new Error("the study does not end");
  }
  /// What the study needs of the computer: the keyboard is there once one of its keys was pressed.
  async needs() {
    const missing = this.page.locator(".needs li.missing");
    await this.page.waitForSelector(".needs");
    check((await missing.count()) > 0, "a keyboard is missing until one of its keys is pressed");
    await this.look("needs");
    await this.page.keyboard.press("ArrowRight");
    if (this.size.width >= 480) await this.page.locator("button.main").waitFor();
  }
  words() { return this.page.locator("main").textContent(); }
}
const somebody = async (what) => new Somebody(await seat.link(), what);

const young = await somebody({ age: 17 });
await young.goThrough();
check((await young.words()).includes("sucht andere Menschen"), "who may not take part is thanked before anything else");
check(!(await young.words()).includes("C1X9"), "and is given no code");

const narrow = await somebody({ size: { width: 400, height: 700 }, looked: true });
await narrow.open();
check((await narrow.page.locator("button.main").count()) === 1 && !(await narrow.page.locator("button.main").isVisible()), "nobody goes on in a window that is too small");
await narrow.page.getByRole("button", { name: "hier beenden" }).press("Enter");
await narrow.page.waitForFunction(() => document.querySelector("main").textContent.includes("braucht einen anderen Computer"));
await narrow.look("other-computer");

const plain = await somebody({});
await plain.goThrough();
const [first, careless] = [await somebody({ size: { width: 1000, height: 760 }, looked: true, lends: true }), await somebody({ attention: 5 })];
await Promise.all([first.goThrough(), careless.goThrough()]);
const [sick, regretful] = [await somebody({ probe: HIGHEST }), await somebody({})];
await Promise.all([sick.goThrough(), regretful.goThrough()]);
const leaver = await somebody({ leavesAt: "Mitfahrt 2" });
await leaver.goThrough();
const levels = ["0 gar nicht", "1", "2", "3", "4 ein wenig", "5", "6", "7 deutlich", "8", "9", "10 sehr · Mir ist nicht gut: anhalten"];
check(first.probed.join() === levels.join(), `during a ride each level has its words, and the highest says that it stops: ${first.probed}`);
check(first.read.includes("Worum es in dieser Studie ging"), "at the end everybody reads what the study was about");
check(sick.read.includes("Sie haben angehalten") && sick.read.includes("Worum es in dieser Studie ging"), "who feels sick is looked after, and told what the study was about");
check(!sick.read.includes("Mitfahrt 2"), "who feels sick rides no more that day");
check((await sick.words()).includes("C1X9"), "who stopped has the code for the payment");
await sick.look("sick");

await regretful.page.getByRole("button", { name: "Löschen, was ich gegeben habe" }).click();
await regretful.page.getByRole("button", { name: "Löschen", exact: true }).click();
await regretful.page.waitForFunction(() => document.querySelector("main").textContent.includes("wurde gelöscht"));
await browser.close();
check((await seat.stop("SIGINT")) === 0, "Ctrl-C ends the server in order");

/// A table's rows, each by its columns; no cell of those that are read here has a comma.
function rows(file) {
  const [head, ...lines] = readFileSync(join(folder, file), "utf8").trim().split("\n");
  const columns = head.split(",");
  return lines.map((line) => Object.fromEntries(line.split(",").map((cell, i) => [columns[i], cell])));
}
const heldBack = rows("seat/not_admitted.csv").map((row) => `${row.rule}: ${row.people}`);
check(heldBack.join() === "demographics.1 >= 18: 1,needs.width_px >= 480: 1", `each rule held back one person, and nothing else is kept of them: ${heldBack}`);
const answers = rows("surveys/answers.csv");
const ids = [...new Set(answers.map((row) => row.participant))].sort();
check(ids.join() === "P003,P004,P005,P006,P008", `answers are kept of those who took part and took nothing back: ${ids}`);
const moments = [...new Set(answers.map((row) => row.moment))].sort();
check(["after", "post", "pre", "probe"].every((moment) => moments.includes(moment)), `each moment has its answers: ${moments}`);
check(!readFileSync(join(folder, "surveys/answers.csv"), "utf8").includes("screen"), "no answer by which it was judged who takes part is kept");
const agreed = rows("seat/consents.csv").map((row) => `${row.participant} ${row.style_lent}`).sort();
check(agreed.join() === "P003 false,P004 true,P005 false,P006 false,P008 false", `who ticked the box lets their style be lent, and nobody else does: ${agreed}`);
const lent = rows("seat/lent.csv");
check(["P003", "P004", "P005"].every((who) => lent.some((row) => row.participant === who)) && lent.every((row) => !/^P0/.test(row.donor)), `who rode in somebody else's style, and that of nobody of this study: ${JSON.stringify(lent)}`);
const stopped = rows("seat/stopped.csv");
check(stopped.length === 1 && stopped[0].participant === "P006" && stopped[0].reason === "feeling >= 6", `one ride was stopped by what was answered: ${JSON.stringify(stopped)}`);
check(answers.some((row) => row.participant === "P006" && row.moment === "probe" && row.answer === String(HIGHEST)), "the number that was typed stopped it, and stands among the answers: 10, not 1");
for (const name of readdirSync(join(folder, "seat")).filter((file) => file.endsWith(".jsonl"))) {
  const told = execFileSync(maveric, ["seat", "replay", join(folder, "seat", name)], { encoding: "utf8" }).trim();
  check(told.includes("the same states, to the byte"), `replay of ${name}: ${told}`);
}

execFileSync(maveric, ["run"], { cwd: folder, encoding: "utf8", stdio: ["ignore", "pipe", "pipe"] });
const page = join(folder, "report", "index.html");
check(existsSync(page), "maveric run ends with the study's page");
const text = readFileSync(page, "utf8").replaceAll(/<style[\s\S]*?<\/style>|<script[\s\S]*?<\/script>|<[^>]+>/g, " ").replaceAll(/\s+/g, " ");
for (const [what, pattern] of [
  ["who was asked and not admitted", /not admitted/i], ["the ride that was stopped", /stopped/i], ["the attention check", /attention/i], ["period", /period/i],
  ["which text was agreed to, and by how many", /Versions of the consent/], ["that a car had somebody else's style", /somebody else’s style/i],
]) check(pattern.test(text), `the page says ${what}`);
end();
