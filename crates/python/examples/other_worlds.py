"""Does the dial turn the right way in worlds that we did not write?

usage: python other_worlds.py FOLDER [DRIVERS] [SECONDS]

In FOLDER the paper's synthetic study is made as far as its personal styles. Each of its test drivers then drives as they do
(mimic), 15 points more aggressive and 15 more cautious: in SUMO's traffic, in highway-env's and in ours. Printed: the study's
measures, by world and condition; in how many drivers aggressive lies above (for gaps: below) cautious; collisions.
Then somebody else's planner, SUMO's IDM, drives in our world.

Needs: pip install maveric[sumo,highway-env]
"""

import json
import sys
from pathlib import Path
from statistics import mean

import maveric

POINTS = {"cautious": -15, "mimic": 0, "aggressive": +15}
# Measure, its unit, and whether aggressive is more of it; None where aggression is not known to move it (as the measure itself says).
MEASURES = [
    ("mean_velocity_mps", "m/s", True),
    ("lane_changes", "", True),
    ("mean_headway_time_s", "s", False),
    ("headway_merge_back_s", "s", False),
    ("headway_merge_back_m", "m", False),
    ("min_headway_distance_m", "m", None),
    ("left_lane_fraction", "", None),
]
COUNTS = ["collisions", "rule_violations", "interventions", "inside_safe_distance_s"]
WORLDS = ("SUMO", "highway-env", "ours")


def styles(folder: Path, drivers: int) -> dict[str, maveric.Style]:
    """The personal styles of the study's test drivers, each from the drive that they drove themselves."""
    if not (folder / "pipelines").exists():
        maveric.command("init", str(folder), "--paper")
    maveric.run("pipelines/paper.toml", "train", "ingest-study2", folder=folder)
    made = folder / "study_data/generated/paper"
    model = maveric.Model.load(made / "model.maveric")
    logs = sorted((made / "logs/study2").glob("*-own.mcap"))[:drivers]
    return {log.stem: model.personalize(maveric.read_log(log)[0]) for log in logs}


def drive(world: str, planner, seconds: float, seed: int):
    """A drive, what was counted in it, and the collisions that the world itself counted."""
    if world == "ours":
        return maveric.simulate(planner, duration_s=seconds, seed=seed), None
    kind = {"SUMO": maveric.sumo.Highway, "highway-env": maveric.highway_env.Highway}[world]
    with kind(seed=seed) as moved:
        return maveric.drive_in(moved, planner, duration_s=seconds), moved.collisions


def row(driven, collisions) -> dict:
    return {**driven.drive.measures(), **driven.report, "collisions_of_the_world": collisions}


def shown(values) -> str:
    there = [v for v in values if v is not None]
    return f"{mean(there):.2f}" if there else "–"


def right_way(pairs, more: bool | None) -> str:
    """In how many drivers aggressive lies on its side of cautious, of those in whom the two differ."""
    if more is None:
        return "–"
    there = [(low, high) for low, high in pairs if low is not None and high is not None and low != high]
    return f"{sum((high > low) is more for low, high in there)} of {len(there)}"


def table(world: str, found: dict, people: list[str]) -> str:
    """The measures' means by condition, and what was counted, summed."""
    lines = [f"**{world}**\n", "| | " + " | ".join(POINTS) + " | right way |", "|---|" + "---|" * (len(POINTS) + 1)]
    for measure, unit, more in MEASURES:
        cells = [[found[world, n, c][measure] for n in people] for c in POINTS]
        shares = right_way(zip(cells[0], cells[-1]), more)
        name = f"{measure} ({unit})" if unit else measure
        lines.append(f"| {name} | {' | '.join(map(shown, cells))} | {shares} |")
    for count in COUNTS if world == "ours" else [*COUNTS, "collisions_of_the_world"]:
        sums = [sum(found[world, n, c][count] for n in people) for c in POINTS]
        lines.append(f"| {count}, sum | {' | '.join(f'{s:g}' for s in sums)} | |")
    return "\n".join(lines)


def main(folder: str, drivers: str = "24", seconds: str = "300") -> None:
    people = styles(Path(folder), int(drivers))
    found = {}
    for world in WORLDS:
        for seed, (name, style) in enumerate(people.items(), 1):
            for condition, points in POINTS.items():
                # The same traffic for each condition of a driver.
                found[world, name, condition] = row(*drive(world, style.dial(points), float(seconds), seed))
            print(f"{world}: {seed} of {len(people)} drivers", file=sys.stderr, flush=True)
    out = {" ".join(key): values for key, values in found.items()}
    Path(folder, "other_worlds.json").write_text(json.dumps(out, indent=1))
    print(f"{len(people)} drivers, {seconds} s a drive")
    for world in WORLDS:
        print(f"\n{table(world, found, list(people))}")
    follower = maveric.sumo.Follower("IDM", speed_mps=30.0)
    rows = [row(maveric.simulate(follower, duration_s=float(seconds), seed=seed), None) for seed in range(1, 6)]
    follower.close()
    print("\n**SUMO's IDM at the wheel in our world**, 5 drives\n\n| | |\n|---|---|")
    for measure, unit, _ in MEASURES:
        print(f"| {measure}{f' ({unit})' if unit else ''} | {shown(r[measure] for r in rows)} |")
    for count in COUNTS:
        print(f"| {count}, sum | {sum(r[count] for r in rows):g} |")


if __name__ == "__main__":
    main(*sys.argv[1:])
