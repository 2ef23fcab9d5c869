// The devices that a browser sees beside the keyboard, each known by its name and place.

/// A device; two of one name are told apart by their place.
export interface Device { id: string; index: number }

export const pads = (): Gamepad[] => navigator.getGamepads().filter((p): p is Gamepad => p !== null && p.connected);

/// A device as it is now: at its place, or at another, since it was plugged in anew; none where it is gone.
export function padAt(device: Device): Gamepad | null {
  const same = pads().filter((p) => p.id === device.id);
  return same.find((p) => p.index === device.index) ?? (same.length === 1 ? same[0] ?? null : null);
}

/// Letters of a device's name that are written down: an event is at most 200 bytes, a letter at most three.
const LONGEST_NAME = 50;
export const named = (device: { id: string }): string => device.id.slice(0, LONGEST_NAME);
