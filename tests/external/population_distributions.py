#!/usr/bin/env python3
"""The synthetic drivers' distributions beside published figures and beside recordings of people.

    cargo run -q --release -p maveric-simulator --example population -- 1000 table > table.csv
    python tests/external/population_distributions.py table.csv DATA [DRIVES]

DATA holds the folders openacc_astazero and ngsim_i80_pairs (see docs/real-data.md); DRIVES is a folder of ingested drives
of synthetic people (`<drive>.parquet`). Needs pandas, and pyarrow for DRIVES. Writes population_distributions.csv beside
this script, and prints the table. Not part of the tests.

Recordings and drives: time gaps are bumper to bumper over ego speed. `following` rows are those with a gap below 3 s and
speeds within 1 m/s, above 5 m/s, for all of them; `n` is the number of drivers, mean and SD are over the drivers' medians,
deciles over all rows, every driver the same weight. `…_halves_icc`: ICC(2,1) of the drivers' means over the two halves of
the first two thirds of their rows (what may be looked at of these recordings).
"""

import csv
import sys
import tomllib
from pathlib import Path

import numpy as np
import pandas as pd

HERE = Path(__file__).parent
FOOT = 0.3048


def recorded(folder, scale):
    """One frame a driver: gap (m), speed and lead speed (m/s)."""
    frames = []
    for path in sorted(folder.glob("*.csv")):
        if path.name == "manifest.csv":
            continue
        f = pd.read_csv(path)
        frames.append(pd.DataFrame(dict(gap=f.spacing * scale, speed=f.v_follower * scale, lead=f.v_leader * scale)))
    return frames


def driven(folder):
    """Drives of synthetic people; free rows have no gap."""
    frames = []
    for path in sorted(folder.glob("*.parquet")):
        f = pd.read_parquet(path, columns=["ego_speed_mps", "lead_present", "lead_dx_m", "lead_dy_m", "lead_speed_mps", "changing"])
        there = f.lead_present & (f.lead_dx_m > 0) & (f.lead_dy_m.abs() < 1.83) & (f.changing == 0)
        frames.append(pd.DataFrame(dict(gap=f.lead_dx_m.where(there), speed=f.ego_speed_mps, lead=f.lead_speed_mps)))
    return frames


def quantities(frames):
    """Time gap while following, its spread within a driver, speed, and speed with nobody within 5 s."""
    gaps, speeds, free = [], [], []
    for f in frames:
        t = f.gap / f.speed.where(f.speed > 5)
        follows = (t < 3) & ((f.speed - f.lead).abs() < 1)
        if follows.sum() >= 50:
            gaps.append(t[follows].to_numpy())
        speeds.append(f.speed[f.speed > 5].to_numpy())
        alone = f.speed[f.gap.isna() | (t > 5)]
        if len(alone) >= 50:
            free.append(alone[alone > 5].to_numpy())
    yield "following_time_gap", "s", gaps
    yield "following_time_gap_within_driver_cv", "-", [np.array([g.std() / g.mean()]) for g in gaps]
    yield "speed", "m/s", [s for s in speeds if len(s)]
    yield "free_speed", "m/s", [s for s in free if len(s)]


def icc_2_1(table):
    """ICC(2,1), absolute agreement, single readings, of a row a driver and a column a reading (McGraw and Wong 1996)."""
    n, k = table.shape
    people, readings, all_ = table.mean(1), table.mean(0), table.mean()
    ms_people = k * ((people - all_) ** 2).sum() / (n - 1)
    ms_readings = n * ((readings - all_) ** 2).sum() / (k - 1)
    rest = table - people[:, None] - readings[None, :] + all_
    ms_rest = (rest**2).sum() / ((n - 1) * (k - 1))
    return (ms_people - ms_rest) / (ms_people + (k - 1) * ms_rest + k * (ms_readings - ms_rest) / n)


def halves(where, frames):
    """How far the two halves of what may be looked at of each driver agree."""
    means = {"speed": [], "following_time_gap": []}
    for f in frames:
        fit = f.iloc[: 2 * len(f) // 3]
        cut = [fit.iloc[: len(fit) // 2], fit.iloc[len(fit) // 2 :]]
        t = [h.gap / h.speed.where(h.speed > 5) for h in cut]
        follows = [(g < 3) & ((h.speed - h.lead).abs() < 1) for g, h in zip(t, cut)]
        means["speed"].append([h.speed.mean() for h in cut])
        if all(x.sum() >= 25 for x in follows):
            means["following_time_gap"].append([g[x].mean() for g, x in zip(t, follows)])
    for quantity, rows in means.items():
        if len(rows) > 2:
            yield [f"{quantity}_halves_icc", "-", where, len(rows), icc_2_1(np.array(rows)), *[float("nan")] * 12, ""]


def weighted_deciles(rows):
    grid = np.linspace(0, 1, 1001)
    pooled = np.sort(np.concatenate([np.quantile(r, grid) for r in rows]))
    return [float(np.quantile(pooled, d / 10)) for d in range(1, 10)]


def describe(where, frames):
    for quantity, unit, rows in quantities(frames):
        if not rows:
            continue
        medians = np.array([np.median(r) for r in rows])
        sd = medians.std(ddof=1) if len(medians) > 1 else float("nan")
        yield [quantity, unit, where, len(rows), medians.mean(), sd, min(r.min() for r in rows), max(r.max() for r in rows),
               *weighted_deciles(rows), ""]


def main():
    table, data = Path(sys.argv[1]), Path(sys.argv[2])
    out = []
    for row in csv.DictReader(open(table)):
        out.append([row["quantity"], row["unit"], "generated: parameters", row["n"],
                    *(float(row[k]) for k in ("mean", "sd", "lowest", "highest", *(f"d{i}" for i in range(1, 10)))),
                    f"retest r {row['retest_r']}, day SD {row['day_sd']}, encounter SD {row['encounter_sd']}"])
    if len(sys.argv) > 3:
        out += describe("generated: drives", driven(Path(sys.argv[3])))
    sources = tomllib.loads((HERE / "../../study_data/population_sources.toml").read_text())["source"]
    for s in sources:
        number = lambda k: s.get(k, float("nan"))
        mark = "read" if s["checked"] else "not read"
        label = "chosen" if s["citation"] == "chosen" else f"source, {mark}: {s['citation'].split(':')[0]}"
        out.append([s["quantity"], s["unit"], label, "", number("mean"), number("sd"), number("low"), number("high"),
                    *[float("nan")] * 9, s["note"]])
    for name, frames in (
        ("recordings: OpenACC", recorded(data / "openacc_astazero", 1.0)),
        ("recordings: NGSIM I-80", recorded(data / "ngsim_i80_pairs", FOOT)),
    ):
        out += [*describe(name, frames), *halves(name, frames)]
    order = ["desired_speed", "free_speed", "speed", "following_time_gap", "following_time_gap_within_driver_cv"]
    rank = lambda q: order.index(q) if q in order else len(order)
    out.sort(key=lambda r: (rank(r[0]), r[0]))
    text = lambda x: "" if isinstance(x, float) and np.isnan(x) else f"{x:.2f}" if isinstance(x, float) else str(x)
    header = ["quantity", "unit", "of", "n", "mean", "sd", "lowest", "highest", *(f"d{i}" for i in range(1, 10)), "note"]
    with open(HERE / "population_distributions.csv", "w", newline="") as f:
        writer = csv.writer(f)
        writer.writerow(header)
        writer.writerows([[text(x) for x in row] for row in out])
    print("| quantity | unit | of | n | mean | SD | lowest | d1 | median | d9 | highest |\n|" + "---|" * 11)
    for r in out:
        print("| " + " | ".join(text(x) for x in (*r[:7], r[8], r[12], r[16], r[7])) + " |")


main()
