// One questionnaire on a page of its own, to be read by who judges a study: drawn as the seat draws it, and nothing is sent.

import { sheet, type Asked } from "./sheet";

const asked = JSON.parse(document.getElementById("sheet")?.textContent ?? "null") as Asked;
async function again(): Promise<void> {
  await sheet(asked);
  return again();
}
void again();
