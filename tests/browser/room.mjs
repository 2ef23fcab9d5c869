// A seat that is open, a browser, and the laboratory's page in it: what each test of the seat begins with.

import { chromium } from "playwright-core";
import { spawn } from "node:child_process";
import { mkdirSync } from "node:fs";
import { join } from "node:path";

export const failures = [];
export const check = (holds, what) => { console.log(`${holds ? "ok" : "FAILED"}: ${what}`); if (!holds) failures.push(what); };
export const pause = (ms) => new Promise((done) => setTimeout(done, ms));
export const shots = process.env.SHOTS;
if (shots) mkdirSync(shots, { recursive: true });
/// Ends a test: how many checks failed, and 1 where one did.
export function end() {
  if (failures.length > 0) console.log(`${failures.length} failed`);
  process.exit(failures.length > 0 ? 1 : 0);
}

export class Seat {
  /// `wrapped`: a program before `maveric`, with its words.
  constructor(maveric, folder, wrapped = []) {
    this.port = 20000 + (process.pid % 20000);
    this.base = `http://127.0.0.1:${this.port}`;
    this.command = [...wrapped, maveric, "seat", folder, "--no-open", "--password", "lab", "--bind", `127.0.0.1:${this.port}`];
    // A test that stops in the middle leaves no server behind.
    process.on("exit", () => this.server?.kill("SIGKILL"));
  }

  async start() {
    const [program, ...words] = this.command;
    this.server = spawn(program, words, { stdio: ["ignore", "inherit", "pipe"] });
    this.stderr = "";
    await new Promise((ready, failed) => {
      this.server.stderr.on("data", (data) => { this.stderr += data; if (this.stderr.includes("the seat is open")) ready(); });
      this.server.on("exit", (code) => failed(new Error(`the seat ended with ${code}: ${this.stderr}`)));
    });
    this.server.removeAllListeners("exit");
  }
  /// Ends the server, and says with which code.
  async stop(signal) {
    const ended = new Promise((done) => this.server.once("exit", done));
    this.server.kill(signal);
    return ended;
  }

  /// The laboratory's page, behind its door; `atTheDoor` looks at that first.
  async openLab(browser, viewport, atTheDoor = async () => {}) {
    this.lab = await (await browser.newContext({ viewport })).newPage();
    await this.lab.goto(`${this.base}/lab`);
    await atTheDoor(this.lab);
    await this.lab.locator("input[type=password]").pressSequentially("lab");
    await this.lab.keyboard.press("Enter");
    await this.lab.waitForSelector("table");
  }
  /// A link for the next person.
  async link() {
    await this.lab.goto(`${this.base}/lab`);
    await this.lab.locator("form[action='/lab/next'] button").press("Enter");
    await this.lab.waitForLoadState();
    return new URL(await this.lab.locator("a[href^='/p/']").last().getAttribute("href"), this.base).href;
  }
}

/// A browser that draws by software.
export const launch = () => chromium.launch({ executablePath: process.env.CHROMIUM, args: ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"] });

export const picture = async (page, name) => { if (shots) await page.screenshot({ path: join(shots, `${name}.png`) }); };
