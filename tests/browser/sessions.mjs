// Somebody chooses a language, rides in a car that is not the seat's, comes for a second session, and goes back to where they came from.
//
// usage: node sessions.mjs MAVERIC FOLDER   (CHROMIUM: the browser; SHOTS: a folder for pictures)
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { Seat, check, end, launch, picture } from "./room.mjs";

const [maveric, folder] = process.argv.slice(2);
const viewport = { width: 1024, height: 700 };
const browser = await launch();
const seat = new Seat(maveric, folder);
await seat.start();
await seat.openLab(browser, viewport);
const page = await (await browser.newContext({ viewport })).newPage();
page.on("pageerror", (error) => check(false, `no error in the page: ${error.message}`));
const heading = (text) => page.waitForFunction((t) => document.querySelector("#drive").hidden && document.querySelector("main h1")?.textContent.includes(t), text, { timeout: 60000 });
const press = () => page.locator("main button.main").press("Enter");
const reads = async (text) => (await page.locator("main").textContent()).includes(text);

await page.goto(`${seat.base}/join?PROLIFIC_PID=5f1a2b3c`);
await heading("Zwei Sitzungen");
await picture(page, "sessions-0-language");
await page.getByRole("button", { name: "Deutsch" }).press("Enter");
await heading("Zwei Sitzungen");
await page.waitForFunction(() => document.documentElement.lang === "de");
check(await reads("Ein deutscher Text."), "the consent is in the language that was chosen");
await press();

/// The rides of a session, each in another rig, and what is asked after it.
async function rides() {
  for (const number of [1, 2]) {
    await heading(`Mitfahrt ${number}`);
    if (number === 1) await picture(page, "sessions-1-elsewhere");
    await press();
    await page.waitForSelector("form fieldset");
    await page.locator("form fieldset input").first().check();
    const first = await page.locator("form").elementHandle();
    await page.locator("form button").press("Enter");
    await page.waitForFunction((gone) => !gone.isConnected, first);
  }
}

await rides();
await heading("Auf Wiedersehen");
check(/20\d\d-\d\d-\d\d/.test(await page.locator("main").textContent()), "the day of the next session is said");
await picture(page, "sessions-2-between");
await page.reload();
await heading("Auf Wiedersehen");
check((await page.locator("main button.main").count()) === 0, "nobody goes on before the day");

// The experimenter lets them go on, for a reason.
await seat.lab.goto(`${seat.base}/lab`);
check(await seat.lab.getByText("between two sessions").isVisible(), "the laboratory says that they are between two sessions");
await picture(seat.lab, "sessions-3-lab");
await seat.lab.getByRole("link", { name: "Step …" }).first().click();
await seat.lab.waitForLoadState();
await picture(seat.lab, "sessions-4-step");
const reason = seat.lab.locator("input[name=reason], textarea[name=reason]").first();
await reason.fill("came a day early");
await seat.lab.locator("[value=skip]").press("Enter");
await seat.lab.waitForLoadState();
await page.reload();
await rides();
await heading("Vielen Dank");
check((await page.locator("main a.button").getAttribute("href")) === "https://pays.example/?cc=DONE", "a button leads back to where they came from");
await picture(page, "sessions-5-thanks");
await seat.stop("SIGINT");
await browser.close();
const answers = readFileSync(join(folder, "surveys/answers.csv"), "utf8").trim().split("\n");
check(answers[0].includes(",session,trial,") && answers.length === 1 + 4, `each ride was answered once: ${answers.length - 1}`);
const payment = readFileSync(join(folder, "seat/payment.csv"), "utf8");
check(payment === "participant,platform_id,ended\nP001,5f1a2b3c,done\n", "who is paid stands in its own file");
end();
