// What this browser keeps of somebody goes when they are forgotten: of whoever opens the link, and of whoever took part here before.

import { token, type State } from "./api";
import { deleteDrafts, peopleOfDrafts } from "./drafts";
import { deleteLines, peopleOfLines } from "./outbox";

/// How the part of somebody ended; null where it did not, or nobody says.
async function ended(whose: string): Promise<string | null> {
  const reply = await fetch(`/api/${whose}`).catch(() => null);
  if (!reply?.ok) return null;
  const state = (await reply.json().catch(() => null)) as { ended?: string | null } | null;
  return state?.ended ?? null;
}

export async function deleteForgotten(state: State): Promise<void> {
  for (const whose of new Set([...(await peopleOfLines()), ...peopleOfDrafts()])) {
    const how = whose === token ? state.ended : await ended(whose);
    if (how !== "deleted") continue;
    await deleteLines(whose);
    deleteDrafts(whose);
  }
}
