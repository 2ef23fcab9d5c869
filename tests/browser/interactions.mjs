// What moves on the page, by mouse and by keyboard; each gives the faults that it found.

const picture = (canvas) => canvas.evaluate((c) => c.toDataURL());

/** Sorts the first sortable table of `page` by mouse, and back by keyboard. */
export async function sorting(page) {
  const faults = [];
  const table = page.locator("table:has(thead button)").first();
  if (!(await table.count())) return ["no table can be sorted"];
  const column = (await table.locator("thead th").count()) - 1;
  const cells = () => table.locator("tbody tr > :last-child").allTextContents();
  const head = table.locator("thead th").nth(column);
  const before = await cells();
  await head.locator("button").click();
  if ((await head.getAttribute("aria-sort")) !== "ascending") faults.push("a click does not sort");
  await head.locator("button").focus();
  await page.keyboard.press("Enter");
  if ((await head.getAttribute("aria-sort")) !== "descending") faults.push("Enter does not turn the order");
  const values = (await cells()).map((t) => parseFloat(t.replace("\u2212", "-"))).filter((v) => !Number.isNaN(v));
  if (values.some((v, i) => i > 0 && v > values[i - 1])) faults.push(`not in descending order: ${values.join(" ")}`);
  await page.keyboard.press("Space");
  if (JSON.stringify(await cells()) !== JSON.stringify(before)) faults.push("the third press does not give the first order back");
  return faults;
}

/** Filters the ledger by verdict, part and text. */
export async function ledger(page) {
  const faults = [];
  const controls = page.locator("[data-filter=ledger]");
  if (!(await controls.isVisible())) return ["the ledger cannot be filtered"];
  const rows = page.locator("#table-claims tr[data-verdict]:visible");
  const all = await rows.count();
  const verdict = controls.locator("[data-by=verdict]");
  const value = await verdict.locator("option").nth(1).getAttribute("value");
  await verdict.selectOption(value);
  const kinds = await rows.evaluateAll((r) => [...new Set(r.map((e) => e.dataset.verdict))]);
  if (kinds.length !== 1 || kinds[0] !== value) faults.push(`verdict ${value} shows ${kinds.join(" ")}`);
  await verdict.selectOption("");
  await controls.locator("[data-by=text]").fill("mean velocity");
  const some = await rows.count();
  if (!(some > 0 && some < all)) faults.push(`the text shows ${some} of ${all}`);
  if (!(await controls.locator("output").textContent()).startsWith(`${some} of ${all}`)) faults.push("the count is not said");
  await controls.locator("[data-by=text]").fill("");
  await controls.locator("[data-by=disagrees]").focus();
  await page.keyboard.press("Space");
  const odd = await rows.count();
  if (!(odd > 0 && odd < all)) faults.push(`“disagrees with itself” shows ${odd} of ${all}`);
  await page.keyboard.press("Space");
  if ((await rows.count()) !== all) faults.push("not all rows come back");
  return faults;
}

/** Turns the embedding space by drag, keys and buttons; names a drive by click and a participant by Enter. */
export async function space(page) {
  const faults = [];
  const live = page.locator("[data-live=space]");
  if (!(await live.count()) || !(await live.isVisible())) return ["the embedding space does not move"];
  const canvas = live.locator("canvas");
  await canvas.scrollIntoViewIfNeeded();
  const changes = async (what, act) => {
    const before = await picture(canvas);
    await act();
    if ((await picture(canvas)) === before) faults.push(`${what} changes nothing`);
  };
  const box = await canvas.boundingBox();
  const middle = [box.x + box.width / 2, box.y + box.height / 2];
  await changes("a drag", async () => {
    await page.mouse.move(...middle);
    await page.mouse.down();
    await page.mouse.move(middle[0] + 60, middle[1] + 10, { steps: 4 });
    await page.mouse.up();
  });
  await canvas.focus();
  for (const key of ["ArrowLeft", "ArrowUp", "+", "Home"]) await changes(key, () => page.keyboard.press(key));
  await changes("a button", () => live.locator("[data-do=right]").click());
  const said = live.locator(".said");
  await canvas.focus();
  await changes("Enter", () => page.keyboard.press("Enter"));
  const first = await said.textContent();
  if (!/^Participant /.test(first)) faults.push(`Enter says “${first}”`);
  await live.locator("select").selectOption({ index: 2 });
  if ((await said.textContent()) === first) faults.push("the list chooses nobody else");
  await live.locator("select").selectOption({ index: 0 });
  // A click on the nearest mark, searched for from the middle outwards.
  let named = false;
  for (let ring = 0; ring < 14 && !named; ring++) {
    for (let step = 0; step < 12 && !named; step++) {
      const angle = (step / 12) * 2 * Math.PI;
      await page.mouse.click(middle[0] + ring * 12 * Math.cos(angle), middle[1] + ring * 12 * Math.sin(angle));
      named = /mph/.test(await said.textContent());
    }
  }
  if (!named) faults.push("no click names a drive");
  return faults;
}

/** Plays, stops and winds the player of drives, by mouse and by keyboard. */
export async function player(page) {
  const faults = [];
  const root = page.locator(".drive-player").first();
  if (!(await root.count()) || !(await root.locator(".pl-play").isVisible())) return ["there is no player that plays"];
  const clock = () => root.locator(".pl-clock").textContent();
  const canvas = root.locator("canvas").first();
  await root.locator(".pl-play").scrollIntoViewIfNeeded();
  const scrub = root.locator(".pl-scrub input");
  await scrub.focus();
  const start = [await clock(), await picture(canvas)];
  await page.keyboard.press("Home");
  const home = [await clock(), await picture(canvas)];
  if (!home[0].startsWith("0:00")) faults.push(`Home shows ${home[0]}`);
  if (start[1] === home[1]) faults.push("Home does not change the picture");
  await page.keyboard.press("ArrowRight");
  if (!(await clock()).startsWith("0:05")) faults.push(`an arrow key shows ${await clock()}`);
  await root.locator(".pl-on").click();
  const event = await clock();
  if (event.startsWith("0:05")) faults.push("the next event is not found");
  await root.locator("[data-times='16']").click();
  if ((await root.locator("[data-times='16']").getAttribute("aria-pressed")) !== "true") faults.push("the speed is not taken");
  await root.locator(".pl-play").click();
  try {
    await page.waitForFunction(([now]) => document.querySelector(".pl-clock").textContent !== now, [event], { timeout: 10000 });
  } catch {
    faults.push("playing does not move the clock");
  }
  await root.locator(".pl-play").click();
  if ((await root.locator(".pl-play").textContent()) !== "Play") faults.push("it does not stop");
  return faults;
}
