// Answers of a questionnaire that was not sent yet, and the time on it: a reload does not lose them.

import { token } from "./api";
import type { Draft } from "./sheet";

const NAME = "maveric-seat-draft";
const name = (step: number): string => `${NAME} ${token} ${step}`;

/// A browser that keeps nothing (a private window) asks all the same.
function trying<T>(work: () => T): T | null {
  try { return work(); } catch { return null; }
}

/// What was done of a step before.
export function draft(step: number): Draft {
  const kept = trying(() => JSON.parse(localStorage.getItem(name(step)) ?? "null") as unknown);
  const { given, seconds } = (kept ?? {}) as { given?: unknown; seconds?: unknown };
  return {
    given: Array.isArray(given) ? given.map((a) => (typeof a === "number" || typeof a === "string" ? a : null)) : [],
    seconds: typeof seconds === "number" ? seconds : 0,
  };
}

export function keepDraft(step: number, draft: Draft): void {
  trying(() => localStorage.setItem(name(step), JSON.stringify(draft)));
}

export function deleteDraft(step: number): void { trying(() => localStorage.removeItem(name(step))); }

const drafts = (): string[][] => trying(() => Object.keys(localStorage).map((key) => key.split(" ")).filter(([first]) => first === NAME)) ?? [];

/// Whose answers this browser keeps.
export function peopleOfDrafts(): string[] { return drafts().map(([, whose]) => whose as string); }

export function deleteDrafts(whose: string): void {
  for (const key of drafts()) if (key[1] === whose) trying(() => localStorage.removeItem(key.join(" ")));
}
