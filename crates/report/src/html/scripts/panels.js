"use strict";
// On a narrow screen the panels of a figure stand one below the other: each is a window on the same drawing.
const narrow = matchMedia("(max-width: 40rem)");
const stack = () => {
  if (!narrow.matches) return;
  for (const box of document.querySelectorAll("figure > [data-cells]:not([data-stacked])")) {
    const drawing = box.querySelector("svg");
    const [, , width, height] = drawing.getAttribute("viewBox").split(" ");
    drawing.id ||= `${box.parentElement.id}-drawing`;
    const panels = box.dataset.cells.split(",").map((cell) => {
      const [panel, use] = ["svg", "use"].map((name) => document.createElementNS(drawing.namespaceURI, name));
      panel.setAttribute("viewBox", cell);
      panel.setAttribute("aria-hidden", "true");
      for (const [key, value] of Object.entries({ href: `#${drawing.id}`, width, height })) use.setAttribute(key, value);
      panel.append(use);
      return panel;
    });
    const stacked = document.createElement("div");
    stacked.className = "stacked";
    stacked.append(...panels);
    box.after(stacked);
    box.dataset.stacked = "";
  }
};
narrow.addEventListener("change", stack);
stack();
