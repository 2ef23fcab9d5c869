// Opens the page in Chromium, light and dark, narrow and wide, without scripts and on paper; then a page that is broken on
// purpose, which has to fail each check.
//
// node test.mjs index.html FOLDER   (CHROMIUM: the program)

import { readFile, stat, writeFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";
import * as checks from "./checks.mjs";
import * as interactions from "./interactions.mjs";
import { sheetsWith } from "./paper.mjs";

const [file, folder] = process.argv.slice(2);
const url = pathToFileURL(file).href;
const axeSource = await readFile(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
const MOST_BYTES = 15e6;
const MOST_SHEETS = 20;
const WIDTHS = [400, 1000, 1600];

let passed = 0;
let failed = 0;
function report(what, faults) {
  if (faults.length === 0) passed++;
  else {
    failed++;
    console.log(`FAILED ${what}`);
    for (const fault of faults.slice(0, 12)) console.log(`       ${fault}`);
    if (faults.length > 12) console.log(`       and ${faults.length - 12} more`);
  }
}

const browser = await chromium.launch({ executablePath: process.env.CHROMIUM, args: ["--no-sandbox", "--disable-gpu"] });

/** A page in a context of its own; what it asks the network for and complains of is kept. */
async function open(address, { width = 1000, height = 900, scheme = "light", scripts = true } = {}) {
  const context = await browser.newContext({
    viewport: { width, height }, colorScheme: scheme, reducedMotion: "reduce", offline: true, javaScriptEnabled: scripts,
  });
  const page = await context.newPage();
  const requests = [];
  const errors = [];
  page.on("request", (r) => { if (!/^(file|data|blob):/.test(r.url())) requests.push(r.url()); });
  page.on("console", (m) => { if (m.type() === "error") errors.push(m.text()); });
  page.on("pageerror", (e) => errors.push(String(e)));
  await page.goto(address, { waitUntil: "load" });
  if (scripts) await page.evaluate(() => document.fonts.ready);
  return { page, requests, errors, close: () => context.close() };
}

/** Without scripts: everything that is read must be there, and nothing that would not work. */
async function withoutScripts(address) {
  const { page, close } = await open(address, { scripts: false });
  const faults = [];
  await page.locator("details.supplement > summary").click();
  for (const id of ["#summary", "#methods", "#exclusions", "#provenance", "figure svg", "main table"]) {
    if (!(await page.locator(id).first().isVisible())) faults.push(`${id} cannot be seen`);
  }
  for (const dead of ["[data-live]", "[data-filter]"]) {
    for (const one of await page.locator(dead).all()) if (await one.isVisible()) faults.push(`${dead} is shown and does nothing`);
  }
  await close();
  return faults;
}

/** The supplement unfolded: what is in it is checked like the rest. */
const unfold = (page) => page.evaluate(() => document.querySelectorAll("details.supplement").forEach((d) => { d.open = true; }));

/** On a first screen of 1280 by 800: every card's question, verdict and answer. */
async function firstScreen(address) {
  const { page, close } = await open(address, { width: 1280, height: 800 });
  const faults = await page.evaluate(() => {
    const cards = [...document.querySelectorAll(".card")];
    const below = cards.filter((c) => c.querySelector(".said p").getBoundingClientRect().bottom > innerHeight);
    const said = below.map((c) => `“${c.querySelector("h3").textContent}” is answered below the first screen`);
    return cards.length ? said : ["no card"];
  });
  await close();
  return faults;
}

/** A table that goes on over sheets of paper has its head on each of them, however it is sorted. */
async function headsOnPaper(address) {
  const { page, close } = await open(address);
  const sheets = await page.evaluate(() => {
    const table = document.querySelector("table:has(thead button)");
    table.tHead.rows[0].cells[0].firstChild.textContent = "Zebraquag";
    const body = table.tBodies[0];
    for (let i = 0; i < 160; i++) body.append(body.rows[0].cloneNode(true));
    document.body.replaceChildren(table);
    return 3;
  });
  const found = sheetsWith(await page.pdf(), "Zebraquag");
  await close();
  return found >= sheets ? [] : [`the head stands on ${found} sheets, expected at least ${sheets}`];
}

/** On paper: a PDF of several pages with headings, no control, every figure. */
async function onPaper(address) {
  const { page, close } = await open(address, { scheme: "dark" });
  const faults = [];
  const pdf = await page.pdf({ tagged: true, outline: true });
  const pages = pdf.toString("latin1").match(/\/Type\s*\/Page\b/g)?.length ?? 0;
  if (pages < 3 || pages >= MOST_SHEETS) faults.push(`${pages} pages, at most ${MOST_SHEETS - 1}`);
  if (!pdf.includes("/Outlines")) faults.push("no outline");
  await page.emulateMedia({ media: "print", colorScheme: "dark" });
  for (const gone of ["nav", "[data-live]", "[data-filter]", ".files"]) {
    for (const one of await page.locator(gone).all()) if (await one.isVisible()) faults.push(`${gone} is printed`);
  }
  faults.push(...(await page.evaluate(() => {
    const ground = getComputedStyle(document.body).backgroundColor;
    return ground === "rgb(255, 255, 255)" ? [] : [`the paper is ${ground}`];
  })));
  await close();
  return [faults, pdf.length];
}

// --- The page itself

const page_bytes = (await stat(file)).size;
report("size", page_bytes < MOST_BYTES ? [] : [`${page_bytes} bytes, at most ${MOST_BYTES}`]);
const paints = [];
for (const scheme of ["light", "dark"]) {
  for (const width of WIDTHS) {
    const { page, requests, errors, close } = await open(url, { width, scheme });
    const name = `${scheme} ${width}:`;
    report(`${name} folded`, await checks.overflow(page));
    await unfold(page);
    report(`${name} fonts`, await checks.fonts(page));
    report(`${name} overflow`, await checks.overflow(page));
    report(`${name} figures`, await checks.figures(page));
    report(`${name} texts inside their figure`, await checks.textsInside(page));
    report(`${name} texts apart`, await checks.textsApart(page));
    report(`${name} axe`, await checks.axe(page, axeSource));
    report(`${name} sorting`, await interactions.sorting(page));
    report(`${name} ledger`, await interactions.ledger(page));
    report(`${name} space`, await interactions.space(page));
    report(`${name} player`, await interactions.player(page));
    if (width === WIDTHS[0]) report(`${name} on a phone`, await checks.onAPhone(page));
    report(`${name} still fits`, await checks.overflow(page));
    report(`${name} network`, requests);
    report(`${name} console`, errors);
    paints.push(await page.evaluate(() => performance.getEntriesByName("first-contentful-paint")[0]?.startTime ?? NaN));
    await close();
  }
}
{
  const { page, close } = await open(url);
  report("links", await checks.links(page));
  await close();
}
report("first screen", await firstScreen(url));
report("heads on paper", await headsOnPaper(url));
report("without scripts", await withoutScripts(url));
const [paper, pdf_bytes] = await onPaper(url);
report("on paper", paper);

// --- A broken page: each check has to find its fault

const html = await readFile(file, "utf8");
const broken = join(folder, "broken.html");
await writeFile(
  broken,
  html
    .replace(/<meta http-equiv="Content-Security-Policy"[^>]*>/, "")
    .replace(/@font-face\s*\{[^}]*\}/, "")
    .replace("</head>", `<link rel="stylesheet" href="https://example.invalid/a.css"></head>`)
    .replace("</main>", `<img src="https://example.invalid/a.png"><div style="width:3000px">wide</div>
      <p style="color:#ccc;background:#fff">pale</p><a href="#nowhere">x</a>
      <figure id="figure-broken"><svg width="200" height="100" viewBox="0 0 200 100"><text x="150" y="50">cut off at the edge</text>
      <text x="10" y="20">one on</text><text x="12" y="22">another</text></svg></figure></main>`)
    .replace('class="card"', 'class="card" style="margin-top:900px"')
    .replace("thead button { display: none; }", "thead { display: table-row-group !important; }")
    .replace('data-live="space" hidden', 'data-live="dead"')
    .replace('data-filter="ledger" hidden', 'data-filter="dead"')
    .replace(/<script>[\s\S]*?<\/script>/g, "<script>nothing.at.all()</script>")
    .replace("wider than this screen", "")
    .replace("nav, .files, .skip, .live, .controls { display: none !important; }", ""),
);
{
  const { page, requests, errors, close } = await open(pathToFileURL(broken).href);
  await unfold(page);
  const proof = (what, faults) => report(`the check of ${what} finds nothing on the broken page`, faults.length ? [] : ["no fault found"]);
  proof("fonts", await checks.fonts(page));
  proof("overflow", await checks.overflow(page));
  proof("figures", await checks.figures(page));
  proof("texts inside", await checks.textsInside(page));
  proof("texts apart", await checks.textsApart(page));
  proof("axe", await checks.axe(page, axeSource));
  proof("sorting", await interactions.sorting(page));
  proof("ledger", await interactions.ledger(page));
  proof("space", await interactions.space(page));
  proof("player", await interactions.player(page));
  proof("links", await checks.links(page));
  proof("network", requests);
  proof("console", errors);
  await page.setViewportSize({ width: 400, height: 900 });
  proof("a phone", await checks.onAPhone(page));
  await close();
  proof("what is left without scripts", await withoutScripts(pathToFileURL(broken).href));
  proof("the first screen", await firstScreen(pathToFileURL(broken).href));
  proof("paper", (await onPaper(pathToFileURL(broken).href))[0]);
}
await browser.close();

const fastest = Math.min(...paints).toFixed(0);
const slowest = Math.max(...paints).toFixed(0);
console.log(`page ${(page_bytes / 1e6).toFixed(2)} MB, PDF ${(pdf_bytes / 1e6).toFixed(2)} MB, first paint ${fastest} to ${slowest} ms`);
console.log(`${passed} passed, ${failed} failed`);
process.exit(failed ? 1 : 0);
