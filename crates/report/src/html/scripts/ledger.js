"use strict";
// The ledger shows the rows that fit every choice.
{
  const controls = document.querySelector("[data-filter=ledger]");
  const parts = [...document.querySelectorAll("#table-claims tbody")];
  const by = (name) => controls.querySelector(`[data-by=${name}]`);
  const said = controls.querySelector("output");
  const rowsOf = (part) => [...part.querySelectorAll("tr[data-verdict]")];
  const total = parts.flatMap(rowsOf).length;
  const filter = () => {
    const words = by("text").value.toLowerCase().split(/\s+/).filter(Boolean);
    let shown = 0;
    for (const part of parts) {
      let any = false;
      for (const row of rowsOf(part)) {
        const text = row.textContent.toLowerCase();
        const fits =
          (!by("verdict").value || row.dataset.verdict === by("verdict").value) &&
          (!by("part").value || part.dataset.part === by("part").value) &&
          (!by("disagrees").checked || row.dataset.disagrees !== undefined) &&
          words.every((word) => text.includes(word));
        row.hidden = !fits;
        any ||= fits;
        shown += fits ? 1 : 0;
      }
      part.hidden = !any;
    }
    said.textContent = `${shown} of ${total} shown`;
  };
  controls.hidden = false;
  controls.addEventListener("input", filter);
  filter();
  // A link to a row that is filtered away shows it again.
  window.addEventListener("hashchange", () => {
    const row = document.getElementById(location.hash.slice(1));
    if (!row?.closest("#table-claims") || !row.hidden) return;
    for (const name of ["text", "verdict", "part"]) by(name).value = "";
    by("disagrees").checked = false;
    filter();
    row.scrollIntoView();
  });
}
