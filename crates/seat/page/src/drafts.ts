// Answers of a questionnaire that was not sent yet: a reload does not lose them.

import { token } from "./api";
import type { Given } from "./sheet";

const NAME = "maveric-seat-draft";
const name = (step: number): string => `${NAME} ${token} ${step}`;

/// A browser that keeps nothing (a private window) asks all the same.
function trying<T>(work: () => T): T | null {
  try { return work(); } catch { return null; }
}

/// What was answered of a step before, item by item: a number, words, or null.
export function draft(step: number): Given[] {
  const kept = trying(() => JSON.parse(localStorage.getItem(name(step)) ?? "[]") as unknown);
  return Array.isArray(kept) ? kept.map((a) => (typeof a === "number" || typeof a === "string" ? a : null)) : [];
}

export function keepDraft(step: number, given: Given[]): void {
  trying(() => localStorage.setItem(name(step), JSON.stringify(given)));
}

export function deleteDraft(step: number): void { trying(() => localStorage.removeItem(name(step))); }

const drafts = (): string[][] => trying(() => Object.keys(localStorage).map((key) => key.split(" ")).filter(([first]) => first === NAME)) ?? [];

/// Whose answers this browser keeps.
export function peopleOfDrafts(): string[] { return drafts().map(([, whose]) => whose as string); }

export function deleteDrafts(whose: string): void {
  for (const key of drafts()) if (key[1] === whose) trying(() => localStorage.removeItem(key.join(" ")));
}
