"use strict";
// Every table of the page can be sorted by each of its columns, by mouse and by keyboard.
for (const table of document.querySelectorAll("table:not([data-plain], .pl-table)")) {
  const body = table.tBodies[0];
  const heads = [...table.tHead.rows[0].cells];
  if (!body || body.rows.length < 2) continue;
  const asGiven = [...body.rows];
  // The first number of a cell, its minus sign and "< .001" included; words have none.
  const number = (text) => {
    const found = text.replaceAll("\u2212", "-").replaceAll("\u00a0", " ").match(/-?(\d+\.?\d*|\.\d+)/);
    return found ? Number(found[0]) : null;
  };
  const sort = (column, direction) => {
    const text = (row) => row.cells[column].textContent.trim();
    const empty = (row) => text(row) === "" || text(row) === "\u2013";
    const numeric = asGiven.filter((row) => !empty(row)).every((row) => number(text(row)) !== null);
    const compare = (a, b) => {
      if (empty(a) || empty(b)) return empty(a) - empty(b);
      const order = numeric ? number(text(a)) - number(text(b)) : text(a).localeCompare(text(b), "en", { numeric: true });
      return direction * order;
    };
    body.append(...(direction === 0 ? asGiven : [...asGiven].sort(compare)));
  };
  heads.forEach((head, column) => {
    const button = document.createElement("button");
    button.type = "button";
    // The words stay in the head itself: Chromium repeats them on every page of paper, what is in a button it leaves blank.
    button.setAttribute("aria-label", `Sort by ${head.textContent}`);
    head.append(button);
    // A third press gives the order in which the table came.
    button.addEventListener("click", () => {
      const now = head.getAttribute("aria-sort");
      const next = now === null ? "ascending" : now === "ascending" ? "descending" : null;
      for (const other of heads) other.removeAttribute("aria-sort");
      if (next) head.setAttribute("aria-sort", next);
      sort(column, next === null ? 0 : next === "ascending" ? 1 : -1);
    });
  });
}
