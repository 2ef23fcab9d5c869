// A scripted person at the keyboard goes through a whole study in a browser; the server is killed and the tab closed in the middle of
// the drive by hand. Then `maveric run` makes the study's page of what was written.
//
// usage: node seat.mjs MAVERIC FOLDER   (CHROMIUM: the browser; SHOTS: a folder for pictures of each step)
import { chromium } from "playwright-core";
import { execFileSync, spawn } from "node:child_process";
import { mkdirSync, readFileSync, existsSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";

const [maveric, folder] = process.argv.slice(2);
const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
const shots = process.env.SHOTS;
if (shots) mkdirSync(shots, { recursive: true });
const sizes = [{ width: 1280, height: 800 }, { width: 1920, height: 1080 }];
const failures = [];
const check = (holds, what) => { console.log(`${holds ? "ok" : "FAILED"}: ${what}`); if (!holds) failures.push(what); };

let server;
const port = 20000 + (process.pid % 20000);
const base = `http://127.0.0.1:${port}`;
async function start() {
  server = spawn(maveric, ["seat", folder, "--no-open", "--password", "lab", "--bind", `127.0.0.1:${port}`], { stdio: ["ignore", "inherit", "pipe"] });
  await new Promise((ready, failed) => {
    let said = "";
    server.stderr.on("data", (data) => { said += data; if (said.includes("the seat is open")) ready(); });
    server.on("exit", (code) => failed(new Error(`the seat ended with ${code}: ${said}`)));
  });
  server.removeAllListeners("exit");
}
async function kill() {
  const gone = new Promise((done) => server.once("exit", done));
  server.kill("SIGKILL");
  await gone;
}

await start();
const browser = await chromium.launch({ executablePath: process.env.CHROMIUM, args: ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"] });
const context = await browser.newContext({ viewport: sizes[0] });
const lab = await context.newPage();
await lab.goto(`${base}/lab`);
await lab.keyboard.type("lab");
await lab.keyboard.press("Enter");
await lab.waitForSelector("table");

async function person() {
  await lab.goto(`${base}/lab`);
  await lab.getByRole("button").press("Enter");
  await lab.waitForLoadState();
  return lab.locator("tbody a").last().getAttribute("href");
}

let page, shot = 0;
async function open(link) {
  page = await context.newPage();
  page.on("pageerror", (error) => check(false, `no error in the page: ${error.message}`));
  page.on("console", (message) => { if (message.type() === "error" && !message.text().includes("Failed to load resource")) check(false, `no error on the console: ${message.text()}`); });
  await page.goto(base + link);
}
const heading = () => page.locator("main h1").first().textContent();
const driving = () => page.locator("#drive").isVisible();
async function look(name) {
  if (!shots) return;
  for (const size of sizes) {
    await page.setViewportSize(size);
    await page.waitForTimeout(350);
    await page.screenshot({ path: join(shots, `${String(shot).padStart(2, "0")}-${name}-${size.width}.png`) });
  }
  await page.setViewportSize(sizes[0]);
  shot++;
}
async function axed(name) {
  await page.evaluate(axe);
  const found = await page.evaluate(async () => (await globalThis.axe.run()).violations.map((v) => `${v.id}: ${v.nodes[0]?.html}`));
  check(found.length === 0, `axe on ${name}: ${found.join("; ") || "nothing"}`);
}
/// Presses Enter on the button that leads on, found as a keyboard finds it.
async function pressMain() {
  for (let i = 0; i < 60; i++) {
    await page.keyboard.press("Tab");
    if (await page.evaluate(() => document.activeElement?.classList.contains("main"))) return page.keyboard.press("Enter");
  }
  throw new Error(`no button to press on: ${await heading()}`);
}

/// Goes on until nothing is left; `middle` is called once in the middle of the drive by hand.
async function goThrough(link, tell, middle) {
  const seen = new Set();
  for (let guard = 0; guard < 80; guard++) {
    await page.waitForFunction(() => document.querySelector("main h1, main form") !== null);
    const title = await heading();
    if (title === "Thank you") { if (tell) { await look("thanks"); await axed("thanks"); } return; }
    const fresh = tell && !seen.has(title);
    seen.add(title);
    if (fresh) { await look(title.toLowerCase().replaceAll(/[^a-z0-9]+/g, "-")); await axed(title); }
    if (await page.locator("form fieldset").count()) {
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
    } else {
      await pressMain();
    }
    await page.waitForTimeout(120);
    if (!(await driving())) { await page.waitForFunction((before) => document.querySelector("main h1")?.textContent !== before || !document.querySelector("#drive").hidden, title, { timeout: 30000 }).catch(() => {}); }
    if (await driving()) {
      const byHand = title === "Your drive" || title === "Practice";
      if (byHand) await page.keyboard.down("ArrowUp");
      await page.waitForTimeout(5000);
      if (fresh || title === "Practice") await look(`${byHand ? "driving" : "riding"}-${title.toLowerCase().replaceAll(" ", "-")}`);
      if (byHand) await page.keyboard.up("ArrowUp");
      if (!byHand) await page.keyboard.press("u");
      if (title === "Your drive" && middle) { const cut = middle; middle = null; await cut(); continue; }
      await page.waitForFunction(() => document.querySelector("#drive").hidden, null, { timeout: 120000 });
    }
    if (fresh && title === "Your drive") tell.driven = true;
    await page.waitForFunction((before) => document.querySelector("main h1")?.textContent !== before || document.querySelector("main form"), title, { timeout: 30000 }).catch(() => {});
  }
  throw new Error("the study does not end");
}

const first = await person();
await open(first);
await goThrough(first, {}, async () => {
  // The server goes without a word, and the tab with it; both come back.
  await kill();
  await page.waitForTimeout(1500);
  await page.close();
  await start();
  await open(first);
  await page.waitForSelector("main h1");
  check((await page.locator("main").textContent()).includes("cut short"), "a drive that was cut short begins again at its step");
});
await page.close();
const second = await person();
await open(second);
await goThrough(second, null, async () => {
  // The network goes and comes back; the drive goes on meanwhile and nothing is lost.
  await context.setOffline(true);
  await page.waitForTimeout(4000);
  await context.setOffline(false);
  await page.waitForFunction(() => document.querySelector("#drive").hidden, null, { timeout: 120000 });
});
await page.close();
await browser.close();
const ended = new Promise((done) => server.once("exit", done));
server.kill("SIGINT");
check((await ended) === 0, "Ctrl-C ends the server in order");

for (const who of ["P001", "P002"]) {
  const record = join(folder, "seat", `${who}-own.jsonl`);
  check(existsSync(record), `the drive of ${who} was kept`);
  const said = execFileSync(maveric, ["seat", "replay", record], { encoding: "utf8" });
  check(said.includes("the same states, to the byte") && said.startsWith("scripted"), `replay of ${who}: ${said.trim()}`);
  const frames = readFileSync(record, "utf8").split("\n").filter((l) => l.includes('"frames"')).map((l) => JSON.parse(l));
  const drawn = frames.reduce((n, c) => n + c.frames.drawn, 0), ticks = frames.reduce((n, c) => n + c.ticks, 0);
  const late = frames.reduce((n, c) => n + c.frames.late, 0), dropped = frames.reduce((n, c) => n + c.frames.dropped_steps, 0);
  console.log(`${who}: ${(drawn / (ticks / 100)).toFixed(1)} pictures for each second driven, ${late} of ${drawn} late, ${dropped} steps left out`);
}
const log = execFileSync(maveric, ["run"], { cwd: folder, encoding: "utf8", stdio: ["ignore", "pipe", "pipe"] });
const report = join(folder, "report", "index.html");
check(existsSync(report), `maveric run ends with the study's page: ${log.trim().split("\n").at(-1)}`);
if (shots) writeFileSync(join(shots, "done.txt"), failures.join("\n"));
if (failures.length > 0) { console.log(`${failures.length} failed`); process.exit(1); }
