// Leaving, and taking back what was given: at any time, and after the end.

import type { State } from "./api";
import { keeper } from "./keeper";
import { make } from "./words";

/// A choice in a dialog: what its button says, and whether what was given is kept.
interface Choice { label: string; keep: boolean }

function ask(title: string, words: string[], choices: Choice[], stays: string): void {
  const problem = make("p", []);
  problem.setAttribute("role", "alert");
  const stay = make("button", [stays], { type: "button", className: "main" });
  const buttons = choices.map(({ label, keep }) => {
    const button = make("button", [label], { type: "button" });
    button.addEventListener("click", () => void leave(keep));
    return button;
  });
  const dialog = make("dialog", [
    make("h1", [title]), ...words.map((w) => make("p", [w])), ...[...buttons, stay].map((b) => make("p", [b])), problem,
  ]);
  const leave = async (keep: boolean): Promise<void> => {
    for (const b of buttons) b.disabled = true;
    try {
      await keeper.leave(keep);
      location.reload();
    } catch (error) {
      problem.textContent = `This cannot be done: ${error instanceof Error ? error.message : String(error)}`;
    }
  };
  stay.addEventListener("click", () => dialog.close());
  dialog.addEventListener("close", () => dialog.remove());
  document.body.append(dialog);
  dialog.showModal();
}

/// Leaving stops at once; the person says what becomes of what was recorded.
export function askWhetherToLeave(): void {
  ask("Leave the study?", [], [
    { label: "Leave, and let what I gave be kept", keep: true },
    { label: "Leave, and have it deleted", keep: false },
  ], "Stay");
}

/// After the end: until when what was given can be taken back, and the button for it.
export function takingBack({ withdraw, ended }: State): HTMLElement[] {
  if (!withdraw || ended === "deleted") return [];
  const { until, open, lasting } = withdraw;
  if (!open) return [make("p", [`What you gave could be taken back until ${until}. Ask whoever runs the study.`])];
  const button = make("button", ["Delete what I gave"], { type: "button" });
  button.addEventListener("click", () =>
    ask("Delete what you gave?", ["Your answers and drives are deleted, and what was learned of you.", lasting], [{ label: "Delete it", keep: false }], "Keep it"));
  const when = until ? `Until ${until} you can take back what you gave` : "You can take back what you gave at any time";
  return [make("p", [`${when}: keep the address of this page for that.`]), make("p", [button])];
}
