#!/usr/bin/env python3
"""The same background traffic in SUMO and here: fundamental diagram, time gaps, and speed.

    python3 -m venv venv && venv/bin/pip install eclipse-sumo numpy pandas
    cargo build --release -p maveric-simulator --example fundamental_diagram
    venv/bin/python tests/external/sumo_compare.py target/release/examples/fundamental_diagram [speed]

Writes sumo_compare.csv beside this script and prints the tables of docs/simulator.md. Not part of the tests.

Both programs get the same drivers (desired speed and time gap drawn once, here), the same start, steps of 0.1 s, and are
measured by the same code from samples once a second. What is matched in SUMO: carFollowModel IDM with accel, decel, tau,
minGap and delta 4; `stepping` 0.1 (its inner step, 0.25 by default); ballistic update (its default is Euler); speedFactor 1
and speedDev 0 (default 0.1), the desired speed being maxSpeed below a higher limit; emergencyDecel 8; no internal lanes, so
that the ring is as long as its edges; vehicles of the ring put in place without insertion checks.
"""

import csv
import os
import resource
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pandas as pd
import sumo

HOME = Path(sumo.SUMO_HOME)
SUMO, NETCONVERT = str(HOME / "bin/sumo"), str(HOME / "bin/netconvert")
OURS = str(Path(sys.argv[1]).resolve()) if len(sys.argv) > 1 else "target/release/examples/fundamental_diagram"
STEP = 0.1
IDM = dict(standstill_m=2.0, acceleration_mps2=0.73, braking_mps2=1.67, length_m=5.0)
HEADER = "lane,front_m,speed_mps,desired_speed_mps,time_gap_s,standstill_m,acceleration_mps2,braking_mps2,length_m"


def drivers(n, seed):
    """Desired speeds 120 km/h ± 10 %, time gaps 1.6 s ± 15 %, cut at two SD; rounded as they are written."""
    rng = np.random.default_rng(seed)
    spread = lambda sd: 1 + sd * np.clip(rng.standard_normal(n), -2, 2)
    return np.round(120 / 3.6 * spread(0.1), 4), np.round(1.6 * spread(0.15), 4)


def equilibrium(gap, v0, tau):
    """Speed at which every driver has `gap`, the slowest of them."""
    low, high = np.zeros_like(v0), v0.copy()
    for _ in range(60):
        v = (low + high) / 2
        slow = 2.0 + v * tau < gap * np.sqrt(np.maximum(0, 1 - (v / v0) ** 4))
        low, high = np.where(slow, v, low), np.where(slow, high, v)
    return float(low.min())


def write_vehicles(path, rows):
    with open(path, "w") as f:
        f.write(HEADER + "\n")
        for r in rows:
            f.write(",".join(f"{x:.6g}" if i != 1 else f"{x:.3f}" for i, x in enumerate(r)) + "\n")


def net(folder, length, ring, lanes=1):
    nodes, edges = [], []
    n = 4 if ring else 1
    corner = [(0, 0), (length / 4, 0), (length / 4, length / 4), (0, length / 4)] if ring else [(0, 0), (length, 0)]
    for i, (x, y) in enumerate(corner):
        nodes.append(f'<node id="n{i}" x="{x}" y="{y}"/>')
    for i in range(n):
        to = (i + 1) % len(corner)
        edges.append(f'<edge id="e{i}" from="n{i}" to="n{to}" numLanes="{lanes}" speed="70" length="{length / n}"/>')
    (folder / "n.xml").write_text(f"<nodes>{''.join(nodes)}</nodes>")
    (folder / "e.xml").write_text(f"<edges>{''.join(edges)}</edges>")
    subprocess.run([NETCONVERT, "-n", "n.xml", "-e", "e.xml", "-o", "net.xml", "--no-internal-links", "true",
                    "--no-turnarounds", "true", "--offset.disable-normalization", "true"],
                   cwd=folder, check=True, capture_output=True)
    return n


def vtype(i, row):
    _, _, _, v0, tau, s0, a, b, length = row
    return (f'<vType id="t{i}" carFollowModel="IDM" accel="{a}" decel="{b}" emergencyDecel="8" apparentDecel="{b}" tau="{tau}" '
            f'minGap="{s0}" delta="4" stepping="{STEP}" maxSpeed="{v0}" speedFactor="1" speedDev="0" length="{length}" '
            f'sigma="0" laneChangeModel="LC2013"/>')


def routes(folder, rows, length, ring, n_edges, laps=1000):
    out = ["<routes>"]
    piece = length / n_edges
    edges = " ".join(f"e{i}" for i in range(n_edges))
    repeat = f' repeat="{laps}"' if ring else ""
    out += [vtype(i, row) for i, row in enumerate(rows)]
    out.append(f'<route id="r" edges="{edges}"{repeat}/>')
    for i, row in enumerate(rows):
        if ring:
            edge = int(row[1] // piece)
            out.append(f'<vehicle id="{i}" type="t{i}" route="r" depart="0" departEdge="{edge}" departLane="{int(row[0])}" '
                       f'departPos="{row[1] - edge * piece:.3f}" departSpeed="{row[2]:.6g}" insertionChecks="none"/>')
        else:
            out.append(f'<vehicle id="{i}" type="t{i}" route="r" depart="{row[1]:.3f}" departPos="base" departSpeed="max"/>')
    out.append("</routes>")
    (folder / "r.xml").write_text("\n".join(out))


def run_sumo(folder, to_s, from_s, method):
    command = [SUMO, "-n", "net.xml", "-r", "r.xml", "--step-length", str(STEP), "--end", str(to_s), "--no-step-log",
               "--time-to-teleport", "-1", "--collision.action", "warn", "--seed", "1", "--fcd-output", "fcd.xml",
               "--device.fcd.period", "1", "--device.fcd.begin", str(from_s), "--precision", "4", "--no-warnings"]
    if method == "ballistic":
        command += ["--step-method.ballistic", "true"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(done.stderr)


def sumo_samples(folder, rows, length, n_edges, ring):
    piece, out = length / n_edges, []
    for _, step in ET.iterparse(folder / "fcd.xml"):
        if step.tag != "timestep":
            continue
        t = float(step.get("time"))
        for v in step:
            edge, lane = v.get("lane").rsplit("_", 1)
            out.append((t, int(v.get("id")), int(lane), int(edge[1:]) * piece + float(v.get("pos")), float(v.get("speed"))))
        step.clear()
    frame = pd.DataFrame(out, columns=["time_s", "id", "lane", "front_m", "speed_mps"])
    frame = frame.sort_values(["time_s", "lane", "front_m"], kind="stable").reset_index(drop=True)
    lengths = np.array([r[8] for r in rows])
    group = frame.groupby(["time_s", "lane"], sort=False)
    lead_x, lead_id = group.front_m.shift(-1), group["id"].shift(-1)
    if ring:
        lead_x = lead_x.fillna(group.front_m.transform("first") + length)
        lead_id = lead_id.fillna(group["id"].transform("first"))
    known = lead_id.notna()
    frame["gap_m"] = np.inf
    frame.loc[known, "gap_m"] = lead_x[known] - frame.front_m[known] - lengths[lead_id[known].astype(int)]
    return frame


def our_samples(folder, shape, length, from_s, to_s):
    text = subprocess.run([OURS, shape, str(length), str(from_s), str(to_s), str(folder / "vehicles.csv")],
                          check=True, capture_output=True, text=True).stdout
    from io import StringIO
    return pd.read_csv(StringIO(text))


def measure(frame, section, seconds):
    """Edie's flow, density and space-mean speed over `section` (m); time gaps of those with 1 m/s or more and gap below 200 m."""
    low, high = section
    inside = frame[(frame.front_m >= low) & (frame.front_m < high)]
    km = (high - low) / 1000
    density = len(inside) / seconds / km
    speed = inside.speed_mps.mean()
    behind = inside[(inside.speed_mps > 1) & (inside.gap_m < 200)]
    gaps = behind.gap_m / behind.speed_mps
    out = dict(density_per_km=density, speed_mps=speed, flow_per_h=density * speed * 3.6,
               time_gap_mean_s=gaps.mean(), time_gap_sd_s=gaps.std())
    out.update({f"time_gap_d{d}_s": np.quantile(gaps, d / 10) for d in range(1, 10)})
    return out


def case(folder, kind, value, method, seeds=(1, 2, 3)):
    """One density (vehicles on a ring of 1 km) or inflow (vehicles an hour on 10 km), mean of some draws of drivers."""
    ours, theirs = [], []
    for seed in seeds:
        if kind == "ring":
            length, from_s, to_s, section = 1000.0, 600, 1500, (0, 1000.0)
            v0, tau = drivers(value, seed)
            speed = equilibrium(length / value - 5.0, v0, tau)
            rows = [(0, 5.0 + i * length / value, speed, v0[i], tau[i], *IDM.values()) for i in range(value)]
        else:
            length, from_s, to_s, section = 10_000.0, 900, 2400, (5000.0, 9000.0)
            rng = np.random.default_rng(seed)
            times = np.cumsum(2.0 + rng.exponential(3600 / value - 2.0, int(to_s / 3600 * value * 1.2)))
            times = np.round(times[times < to_s], 1)
            v0, tau = drivers(len(times), seed)
            rows = [(0, times[i], 0, v0[i], tau[i], *IDM.values()) for i in range(len(times))]
        write_vehicles(folder / "vehicles.csv", rows)
        n = net(folder, length, kind == "ring")
        routes(folder, rows, length, kind == "ring", n)
        run_sumo(folder, to_s + STEP, from_s, method)
        theirs.append(measure(sumo_samples(folder, rows, length, n, kind == "ring"), section, to_s - from_s + 1))
        ours.append(measure(our_samples(folder, kind, length, from_s, to_s), section, to_s - from_s + 1))
    mean = lambda all_: {k: float(np.mean([one[k] for one in all_])) for k in all_[0]}
    return mean(ours), mean(theirs)


def cpu(command, cwd):
    """Processor time of a command in s, and what it printed: fair on a busy machine."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(command, cwd=cwd, capture_output=True, text=True, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, done.stdout


def speeds(folder):
    """Vehicle-steps per second of processor time, start-up included, best of three runs of both programs by turns."""
    print("\n| lanes | vehicles | SUMO, M/s | here, M/s | ratio |\n|---|---|---|---|---|")
    for lanes in (1, 3):
        for count in (10, 1000):
            length = -(-count // lanes) * 50.0
            v0, tau = drivers(count, 1)
            speed = equilibrium(45.0, v0, tau)
            rows = [(i % lanes, (5.0 + (i // lanes) * 50.0 + 7 * (i % lanes)) % length, speed, v0[i], tau[i], *IDM.values())
                    for i in range(count)]
            n = net(folder, length, True, lanes)
            routes(folder, rows, length, True, n)
            seconds = 5000 if count == 10 else 60
            sumo_command = [SUMO, "-n", "net.xml", "-r", "r.xml", "--step-length", str(STEP), "--end", str(seconds), "--no-step-log",
                            "--time-to-teleport", "-1", "--no-warnings", "--step-method.ballistic", "true"]
            theirs, ours = 0.0, 0.0
            for _ in range(3):
                spent, _ = cpu(sumo_command, folder)
                theirs = max(theirs, seconds / STEP * count / spent)
                spent, text = cpu([OURS, "speed", str(lanes), str(count)], folder)
                ours = max(ours, int(text.split(",")[1]) / spent)
            print(f"| {lanes} | {count} | {theirs / 1e6:.2f} | {ours / 1e6:.1f} | {ours / theirs:.0f} |", flush=True)


def main():
    os.environ["SUMO_HOME"] = str(HOME)
    table = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        if sys.argv[2:] == ["speed"]:
            speeds(folder)
            return
        rings, inflows = (5, 10, 15, 20, 25, 30, 40, 50, 60, 80), (400, 800, 1200, 1500)
        # SUMO's default update beside it, at some of the densities.
        for method, cases in (("ballistic", (("ring", rings), ("open", inflows))), ("euler", (("ring", (10, 25, 40, 80)), ("open", (1200,))))):
            for kind, values in cases:
                for value in values:
                    ours, theirs = case(folder, kind, value, method)
                    for quantity in ours:
                        a, b = ours[quantity], theirs[quantity]
                        table.append((method, kind, value, quantity, a, b, 100 * (a / b - 1) if b else float("nan")))
                    show = {q: f"{ours[q]:.2f}/{theirs[q]:.2f}" for q in ("speed_mps", "flow_per_h", "time_gap_mean_s", "time_gap_sd_s")}
                    print(method, kind, value, show, flush=True)
        with open(Path(__file__).with_name("sumo_compare.csv"), "w", newline="") as f:
            writer = csv.writer(f)
            writer.writerow(["sumo_update", "road", "vehicles_or_per_hour", "quantity", "here", "sumo", "difference_percent"])
            writer.writerows([(*r[:4], f"{r[4]:.4f}", f"{r[5]:.4f}", f"{r[6]:.2f}") for r in table])
        frame = pd.DataFrame(table, columns=["method", "road", "value", "quantity", "here", "sumo", "percent"])
        print("\nlargest difference in percent:")
        print(frame.groupby(["method", "road", "quantity"]).percent.agg(lambda p: p.abs().max()).unstack().round(2).to_string())
        speeds(folder)


main()
