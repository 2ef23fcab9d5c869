// The sentences of the page, in the study's language: the page was sent with them.

const sentences = JSON.parse(document.getElementById("words")?.textContent ?? "{}") as Record<string, string>;

/// The sentence of this name, with its parts filled in.
export function say(name: string, parts: Record<string, string | number> = {}): string {
  return (sentences[name] ?? name).replace(/\{(\w+)\}/g, (whole, part: string) => String(parts[part] ?? whole));
}

/// A duration in words that is not off by more than a twentieth.
export function duration(seconds: number): string {
  const whole = Math.round(seconds / 60);
  if (Math.abs(60 * whole - seconds) > 0.05 * seconds) return say("seconds", { n: Math.round(seconds) });
  return whole === 1 ? say("one_minute") : say("minutes", { n: whole });
}

/// Fills in what stands in the page from its beginning.
export function sayWhatStands(): void {
  for (const element of document.querySelectorAll<HTMLElement>("[data-say]")) element.textContent = say(element.dataset["say"] as string);
  for (const element of document.querySelectorAll<HTMLElement>("[data-label]")) element.ariaLabel = say(element.dataset["label"] as string);
}
