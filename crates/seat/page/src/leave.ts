// Leaving, and taking back what was given: at any time, and after the end.

import { keeper, type State } from "./api";
import { say } from "./say";
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
    make("h1", [title], { id: "asked" }), ...words.map((w) => make("p", [w])), ...[...buttons, stay].map((b) => make("p", [b])), problem,
  ]);
  const leave = async (keep: boolean): Promise<void> => {
    for (const b of buttons) b.disabled = true;
    try {
      await keeper.leave(keep);
      location.reload();
    } catch (error) {
      problem.textContent = say("cannot_be_done", { why: error instanceof Error ? error.message : String(error) });
    }
  };
  stay.addEventListener("click", () => dialog.close());
  dialog.addEventListener("close", () => dialog.remove());
  dialog.setAttribute("aria-labelledby", "asked");
  // A key that is held since it opened the dialog answers nothing.
  dialog.addEventListener("keydown", (event) => { if (event.repeat && event.key === "Enter") event.preventDefault(); });
  document.body.append(dialog);
  dialog.showModal();
  // Pressed once more by mistake, the key leaves everything as it is.
  stay.focus();
}

/// Leaving stops at once; the person says what becomes of what was recorded.
export function askWhetherToLeave(): void {
  ask(say("leave_title"), [], [
    { label: say("leave_keep"), keep: true },
    { label: say("leave_delete"), keep: false },
  ], say("stay"));
}

/// After the end: until when what was given can be taken back, and the button for it.
export function takingBack({ withdraw, ended }: State): HTMLElement[] {
  if (ended === "deleted" || ended === "not admitted" || ended === "never came") return [];
  const { until, open } = withdraw;
  if (!open) return [make("p", [say("withdraw_over", { until: until ?? "" })])];
  const button = make("button", [say("delete")], { type: "button" });
  button.addEventListener("click", () =>
    ask(say("delete_title"), [say("delete_what"), say("lasting")], [{ label: say("delete_it"), keep: false }], say("keep_it")));
  const when = until ? say("withdraw_until", { until }) : say("withdraw_always");
  return [make("p", [when]), make("p", [button])];
}
