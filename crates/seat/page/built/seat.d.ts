/* tslint:disable */
/* eslint-disable */

/**
 * A drive or a ride under way.
 */
export class PageDrive {
    private constructor();
    free(): void;
    [Symbol.dispose](): void;
    /**
     * A person (`human`) or a script (`scripted`) at the wheel.
     */
    static by_hand(json: string, seconds: number, seed: string, driven_by: string): PageDrive;
    /**
     * The piece of the record since the last, as a line; `frames` as in [`Frames`]: drawn, late, left out, longest, input.
     */
    chunk(frames: Uint32Array | number[]): string;
    /**
     * Ends the drive.
     */
    finish(): PageDriven;
    /**
     * First line of the record.
     */
    header(): string;
    /**
     * Drives so many steps by keys: bits 1 left, 2 right, 4 faster, 8 slower, 16 emergency brake. False once it is over.
     */
    keys(down: number, way: number, steps: number): boolean;
    /**
     * Writes something down, with a number where it has one.
     */
    note(what: string, number?: number | null): void;
    /**
     * Drives so many steps by a gamepad's stick and triggers.
     */
    pad(steering: number, throttle: number, brake: number, way: number, steps: number): boolean;
    /**
     * Where places of the road lie on the map: for each (x, y) given, (x, y, heading).
     */
    places(road: Float64Array | number[]): Float64Array;
    /**
     * What was practised until now: time for which a lane was kept (s), vehicles passed.
     */
    practised(): Float64Array;
    /**
     * A ride in a style (as a step has it, in JSON) of somebody whose own is `own` (empty: nothing was learned), at so many points on the dial.
     */
    static ride(json: string, seconds: number, seed: string, model: PageModel, own: Float64Array | number[], style: string, points: number): PageDrive;
    /**
     * Rides so many steps. What is shown again is over where it was.
     */
    rides(steps: number): boolean;
    /**
     * Lanes, their width, posted speed (m/s), the shoulders right and left, length and width of the cars, duration (s).
     */
    road(): Float64Array;
    /**
     * What can be seen: time since the row, row time, x, y, heading, speed, wheel angle, collisions, barrier touches, ego's lane, the lane a
     * change came from (-1: none), turn signal, throttle, brake; then id, x, y, speed of each vehicle at the row's time.
     */
    seen(): Float64Array;
    /**
     * A drive by hand once more, as a ride: `lines` is its record.
     */
    static shown(json: string, seconds: number, seed: string, lines: string): PageDrive;
    /**
     * Steps driven.
     */
    ticks(): number;
    /**
     * Turns the dial of a ride to so many points from the person's own style, as far as it goes: gives where it is now.
     */
    turn(points: number): number;
    /**
     * Drives so many steps by a wheel turned so far (rad, left positive) and pedals.
     */
    wheel(turned_rad: number, throttle: number, brake: number, way: number, steps: number): boolean;
}

/**
 * A drive that is over.
 */
export class PageDriven {
    private constructor();
    free(): void;
    [Symbol.dispose](): void;
    /**
     * Last line of the record.
     */
    end(): string;
    /**
     * Learns a style from it: a [`Fit`](crate::Fit) as JSON.
     */
    fit(model: PageModel): string;
}

/**
 * A trained model.
 */
export class PageModel {
    free(): void;
    [Symbol.dispose](): void;
    /**
     * Reads a model file.
     */
    constructor(bytes: Uint8Array | number[]);
}

/**
 * Drives the record in `lines` again: `{"same": …, "end_tick": …, "states": …}`.
 */
export function replay(lines: string): string;

export type InitInput = RequestInfo | URL | Response | BufferSource | WebAssembly.Module;

export interface InitOutput {
    readonly memory: WebAssembly.Memory;
    readonly __wbg_pagedrive_free: (a: number, b: number) => void;
    readonly __wbg_pagedriven_free: (a: number, b: number) => void;
    readonly __wbg_pagemodel_free: (a: number, b: number) => void;
    readonly pagedrive_by_hand: (a: number, b: number, c: number, d: number, e: number, f: number, g: number) => [number, number, number];
    readonly pagedrive_chunk: (a: number, b: number, c: number) => [number, number, number, number];
    readonly pagedrive_finish: (a: number) => [number, number, number];
    readonly pagedrive_header: (a: number) => [number, number, number, number];
    readonly pagedrive_keys: (a: number, b: number, c: number, d: number) => number;
    readonly pagedrive_note: (a: number, b: number, c: number, d: number, e: number) => void;
    readonly pagedrive_pad: (a: number, b: number, c: number, d: number, e: number, f: number) => number;
    readonly pagedrive_places: (a: number, b: number, c: number) => [number, number];
    readonly pagedrive_practised: (a: number) => [number, number];
    readonly pagedrive_ride: (a: number, b: number, c: number, d: number, e: number, f: number, g: number, h: number, i: number, j: number, k: number) => [number, number, number];
    readonly pagedrive_rides: (a: number, b: number) => number;
    readonly pagedrive_road: (a: number) => [number, number];
    readonly pagedrive_seen: (a: number) => [number, number];
    readonly pagedrive_shown: (a: number, b: number, c: number, d: number, e: number, f: number, g: number) => [number, number, number];
    readonly pagedrive_ticks: (a: number) => number;
    readonly pagedrive_turn: (a: number, b: number) => [number, number, number];
    readonly pagedrive_wheel: (a: number, b: number, c: number, d: number, e: number, f: number) => number;
    readonly pagedriven_end: (a: number) => [number, number, number, number];
    readonly pagedriven_fit: (a: number, b: number) => [number, number, number, number];
    readonly pagemodel_new: (a: number, b: number) => [number, number, number];
    readonly replay: (a: number, b: number) => [number, number, number, number];
    readonly __wbindgen_externrefs: WebAssembly.Table;
    readonly __wbindgen_malloc: (a: number, b: number) => number;
    readonly __wbindgen_realloc: (a: number, b: number, c: number, d: number) => number;
    readonly __wbindgen_free: (a: number, b: number, c: number) => void;
    readonly __externref_table_dealloc: (a: number) => void;
    readonly __wbindgen_start: () => void;
}

export type SyncInitInput = BufferSource | WebAssembly.Module;

/**
 * Instantiates the given `module`, which can either be bytes or
 * a precompiled `WebAssembly.Module`.
 *
 * @param {{ module: SyncInitInput }} module - Passing `SyncInitInput` directly is deprecated.
 *
 * @returns {InitOutput}
 */
export function initSync(module: { module: SyncInitInput } | SyncInitInput): InitOutput;

/**
 * If `module_or_path` is {RequestInfo} or {URL}, makes a request and
 * for everything else, calls `WebAssembly.instantiate` directly.
 *
 * @param {{ module_or_path: InitInput | Promise<InitInput> }} module_or_path - Passing `InitInput` directly is deprecated.
 *
 * @returns {Promise<InitOutput>}
 */
export default function __wbg_init (module_or_path?: { module_or_path: InitInput | Promise<InitInput> } | InitInput | Promise<InitInput>): Promise<InitOutput>;
