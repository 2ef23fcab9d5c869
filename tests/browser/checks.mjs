// What is asked of a page: each check takes an open page and gives the faults that it found, in words.

/** Elements that stick out of the page on the right, and a page wider than its window. */
export const overflow = (page) =>
  page.evaluate(() => {
    const faults = [];
    const root = document.documentElement;
    if (root.scrollWidth > root.clientWidth) faults.push(`the page is ${root.scrollWidth} px wide in a window of ${root.clientWidth}`);
    // What lies in a box that scrolls is allowed to be wider than it.
    const inScroll = (e) => e.parentElement?.closest(".scroll, .pl-scroll, pre, nav") != null;
    for (const e of document.body.querySelectorAll("*")) {
      if (e.closest("svg") && e.tagName !== "svg") continue;
      if (e.closest(".skip, .unseen") || inScroll(e)) continue;
      const right = e.getBoundingClientRect().right;
      if (right > root.clientWidth + 1) faults.push(`<${e.tagName.toLowerCase()} class="${e.getAttribute("class") ?? ""}"> ends at ${Math.round(right)} px`);
    }
    return faults.slice(0, 10);
  });

/** The page's three faces, each loaded. */
export const fonts = (page) =>
  page.evaluate(async () => {
    await document.fonts.ready;
    const states = [...document.fonts].map((f) => `${f.family} ${f.weight} ${f.style}: ${f.status}`);
    const faults = states.filter((s) => !s.endsWith(": loaded"));
    if (states.length !== 3) faults.push(`${states.length} faces, expected 3`);
    return faults;
  });

/** Figures that have no size, no title, or no words for who cannot see them. */
export const figures = (page) =>
  page.evaluate(() => {
    const all = [...document.querySelectorAll("figure svg:not([aria-hidden])")];
    const faults = all.length ? [] : ["no figure"];
    for (const svg of all) {
      const box = svg.getBoundingClientRect();
      const name = svg.closest("figure").id;
      if (box.width < 100 || box.height < 40) faults.push(`${name} is ${Math.round(box.width)} by ${Math.round(box.height)} px`);
      if (!svg.querySelector("title")?.textContent.trim()) faults.push(`${name} has no title`);
      if (!svg.querySelector("desc")?.textContent.trim()) faults.push(`${name} has no description`);
      if (!svg.closest("figure").querySelector("figcaption")?.textContent.trim()) faults.push(`${name} has no caption`);
    }
    for (const img of document.images) if (!img.complete || img.naturalWidth === 0) faults.push(`image not loaded: ${img.src}`);
    return faults;
  });

/** Texts of a figure that reach out of it. */
export const textsInside = (page) =>
  page.evaluate(() => {
    const faults = [];
    for (const svg of document.querySelectorAll("figure svg:not([aria-hidden])")) {
      const frame = svg.getBoundingClientRect();
      for (const text of svg.querySelectorAll("text")) {
        const box = text.getBoundingClientRect();
        const out = Math.max(frame.left - box.left, box.right - frame.right, frame.top - box.top, box.bottom - frame.bottom);
        if (out > 1.5) faults.push(`${svg.closest("figure").id}: “${text.textContent}” is ${out.toFixed(1)} px outside`);
      }
    }
    return faults;
  });

/** Texts of a figure that lie on each other. */
export const textsApart = (page) =>
  page.evaluate(() => {
    const faults = [];
    for (const svg of document.querySelectorAll("figure svg:not([aria-hidden])")) {
      const texts = [...svg.querySelectorAll("text")].filter((t) => t.textContent.trim()).map((t) => {
        // The box of a line of text has room above and below its letters: its middle counts.
        const box = t.getBoundingClientRect();
        const upright = t.getAttribute("transform")?.includes("rotate");
        const [dx, dy] = upright ? [box.width * 0.22, 0.5] : [0.5, box.height * 0.22];
        return { text: t.textContent, left: box.left + dx, right: box.right - dx, top: box.top + dy, bottom: box.bottom - dy };
      });
      for (let i = 0; i < texts.length; i++) {
        for (let j = i + 1; j < texts.length; j++) {
          const [a, b] = [texts[i], texts[j]];
          const wide = Math.min(a.right, b.right) - Math.max(a.left, b.left);
          const high = Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top);
          if (wide > 1 && high > 1) faults.push(`${svg.closest("figure").id}: “${a.text}” and “${b.text}” collide`);
        }
      }
    }
    return faults;
  });

/** Figures of several panels that neither stand panel below panel nor fit, and wide ones that say nothing of going on sideways. */
export const onAPhone = (page) =>
  page.evaluate(() => {
    const faults = [];
    for (const box of document.querySelectorAll("figure > .scroll")) {
      const name = box.parentElement.id;
      const stacked = box.parentElement.querySelector(".stacked");
      if (stacked) {
        const parts = [...stacked.children].map((svg) => svg.getBoundingClientRect());
        if (parts.length < 2) faults.push(`${name} stands in ${parts.length} part`);
        if (parts.some((p) => p.width < 250 || p.right > innerWidth)) faults.push(`${name}: a panel is not as wide as the screen`);
        if (box.getBoundingClientRect().height > 0) faults.push(`${name} is shown twice`);
        if (parts.some((p, i) => i > 0 && p.top < parts[i - 1].bottom - 1)) faults.push(`${name}: panels stand on each other`);
      } else if (box.scrollWidth > box.clientWidth + 1) {
        const cue = getComputedStyle(box, "::after").content;
        if (!cue.includes("sideways")) faults.push(`${name} goes on to the right and does not say so`);
      }
    }
    for (const box of document.querySelectorAll(".table .scroll")) {
      if (box.scrollWidth > box.clientWidth + 1 && !getComputedStyle(box).backgroundImage.includes("gradient")) faults.push("a table is cut off without a shadow");
    }
    if (!document.querySelector(".stacked")) faults.push("no figure has its panels one below the other");
    return faults;
  });

/** What axe-core finds. */
export const axe = async (page, source) => {
  // The page's own policy lets no script in; evaluate() does not go through it.
  await page.evaluate(source);
  const found = await page.evaluate(() => axe.run(document, { preload: false }));
  return found.violations.map((v) => `${v.id}: ${v.help} (${v.nodes.length}×, first ${v.nodes[0].html.slice(0, 120)})`);
};

/** Links within the page that lead nowhere, ids that are used twice. */
export const links = (page) =>
  page.evaluate(() => {
    const faults = [];
    for (const a of document.querySelectorAll("a[href^='#']")) {
      if (!document.getElementById(decodeURIComponent(a.getAttribute("href").slice(1)))) faults.push(`no target: ${a.getAttribute("href")}`);
    }
    const ids = [...document.querySelectorAll("[id]")].map((e) => e.id);
    const seen = new Set();
    for (const id of ids) {
      if (seen.has(id)) faults.push(`id used twice: ${id}`);
      seen.add(id);
    }
    return faults;
  });
