#!/usr/bin/env python3
"""Draws random data sets of every design of `maveric stats` and computes each number a second time.

usage: stats_differential.py --out DIR [--cases 300] [--seed 1] [--bin target/release/maveric]

Every case is a folder with data.csv and expected.json, as in crates/stats/tests/oracle. With --bin the program is called on
each and compared; `STATS_CASES=DIR cargo test -p maveric-stats --test oracle` holds the library alone against them.
Sums are exact fractions of the numbers as written, functions have 50 digits (mpmath); exact p values are counted with whole
numbers; only Shapiro-Wilk, noncentral F and the numbers named after SciPy come from SciPy itself.
Needs numpy, scipy, mpmath.
"""
import argparse, json, math, pathlib, random, subprocess, sys
from collections import Counter
from fractions import Fraction as Q

import mpmath as mp

from stats_second_opinion import (
    EXACT, Checks, between, correlation, items, p_adjust, p_r, power_of, rm_corr, sample, within,
)

# Random data.
def number(rng, kind):
    z = rng.gauss(0, 1)
    return {
        "unit": lambda: f"{z:.2f}", "long": lambda: repr(z * 37.5), "likert": lambda: str(min(7, max(1, round(4 + 1.3 * z)))),
        "binary": lambda: str(int(z > 0.4)), "offset": lambda: f"{1e9 + z:.4f}", "small": lambda: f"{z * 1e-9:.4e}",
        "large": lambda: f"{z * 1e30:.6e}", "far": lambda: f"{1e12 + 8 * z:.2f}", "skew": lambda: f"{math.exp(1.5 * z):.3f}", "tenths": lambda: f"{1.5 + 0.4 * z:.1f}",
    }[kind]()


KINDS = ["unit", "unit", "long", "likert", "binary", "offset", "small", "large", "skew", "tenths", "far"]


def draw_within(rng, i):
    shapes = [(2, 2), (3, 3), (2, 4), (4, 6), (5, 2), (8, 3), (12, 4), (24, 4), (9, 4), (30, 5), (7, 10), (60, 3), (150, 2), (400, 3), (6, 5), (250, 2), (3, 8)]
    n, k = shapes[i % len(shapes)]
    kind = KINDS[(i // len(shapes) + i) % len(KINDS)]
    effect = rng.choice([0, 0, 0.5, 3, 40])
    rows = []
    for _ in range(n):
        own = rng.gauss(0, 1)
        row = [number(rng, kind) for _ in range(k)]
        if kind in ("unit", "long", "tenths", "offset"):
            places = {"unit": 2, "long": 12, "tenths": 1, "offset": 4}[kind]
            row = [str(round(float(x) + effect * j + own, places)) for j, x in enumerate(row)]
        rows.append(row)
    special = i % 11
    if special == 3 and k > 2:  # one condition is nearly the mean of two others
        for row in rows:
            row[2] = str(round((float(row[0]) + float(row[1])) / 2 + rng.gauss(0, 1) * 1e-5, 9)) if kind == "unit" else row[2]
    if special == 5:  # a condition repeats another for most subjects
        for row in rows[: max(1, 2 * n // 3)]:
            row[1] = row[0]
    if special == 7:
        for row in rows:
            row[0] = rows[0][0]
    names = rng.sample(["mimic", "aggressive", "cautious", "perpendicular", "b", "a", "z 1", "C", "été", "10", "2", "x.y"], k)
    lines = ["subject,condition,value"]
    full = []
    for s, row in enumerate(rows):
        gap = special == 9 and n > 6 and s % 4 == 1
        for j, x in enumerate(row):
            if gap and j == s % k:
                if s % 8 == 1:
                    lines.append(f"S{s},{names[j]},")
                continue
            lines.append(f"S{s},{names[j]},{x}")
        if not gap:
            full.append([Q(x) for x in row])
    c = Checks()
    within(full, names, c)
    return "within", lines, c, {"conditions": names}


def draw_correlation(rng, i):
    n = [3, 4, 5, 6, 7, 8, 9, 9, 12, 15, 24, 40, 60, 200, 2, 49, 50, 1500][i % 18]
    kind, other = KINDS[i % len(KINDS)], KINDS[(3 * i + 1) % len(KINDS)]
    rho = rng.choice([0, 0.3, 0.9, -0.7])
    x = [number(rng, kind) for _ in range(n)]
    y = [number(rng, other) for _ in range(n)]
    if kind == other == "unit" or i % 5 == 0:
        y = [f"{rho * float(a) + 0.3 * rng.gauss(0, 1) * (abs(float(a)) or 1):.6g}" for a in x]
    lines = ["x,y"] + [f"{a},{b}" for a, b in zip(x, y)]
    if i % 4 == 0:
        lines[1:1] = [f"{x[0]},", f",{y[0]}"]
    c = Checks()
    correlation([Q(float(a)) for a in x], [Q(float(b)) for b in y], c)
    return "correlation", lines, c, {}


def draw_rm_corr(rng, i):
    lines, subjects, x, y = ["subject,x,y"], [], [], []
    for s in range(rng.randint(2, 9)):
        for _ in range(rng.randint(1, 6)):
            a, b = number(rng, KINDS[i % len(KINDS)]), number(rng, KINDS[(i + 2) % len(KINDS)])
            lines.append(f"P{s},{a},{b}")
            subjects.append(s), x.append(Q(float(a))), y.append(Q(float(b)))
    c = Checks()
    rm_corr(subjects, x, y, c)
    return "rm_corr", lines, c, {}


def draw_items(rng, i):
    n, k = rng.choice([5, 9, 24, 90]), rng.choice([2, 3, 6, 11, 25])
    rows = []
    for _ in range(n):
        own = rng.gauss(0, 1)
        rows.append([str(min(5, max(1, round(3 + (-1 if i % 3 == 0 and j == 0 else 1) * own + 0.9 * rng.gauss(0, 1))))) for j in range(k)])
    if i % 4 == 1:
        for row in rows:
            row[-1] = "3"
    if i % 4 == 2:
        rows[0][0] = ""
    lines = [",".join(f"i{j}" for j in range(k))] + [",".join(r) for r in rows]
    c = Checks()
    items([[Q(x) if x else None for x in r] for r in rows], c)
    return "items", lines, c, {}


def draw_sample(rng, i):
    n = [1, 2, 3, 4, 5, 6, 11, 12, 20, 50, 51, 300, 2000, 5000][i % 14]
    v = [number(rng, KINDS[(i // 3 + i) % len(KINDS)]) for _ in range(n)]
    c = Checks()
    sample([Q(float(x)) for x in v], c)
    return "sample", ["value", *v], c, {}


def draw_between(rng, i):
    groups, values = [], []
    for g in range(rng.randint(2, 6)):
        for _ in range(rng.choice([1, 2, 3, 5, 8, 30])):
            groups.append(f"g{g}"), values.append(number(rng, KINDS[i % len(KINDS)]))
    if max(Counter(groups).values()) < 2:
        groups.append(groups[0]), values.append(number(rng, KINDS[i % len(KINDS)]))
    c = Checks()
    between(groups, [Q(float(v)) for v in values], c)
    return "between", ["group,value"] + [f"{g},{v}" for g, v in zip(groups, values)], c, {}


def draw_p_adjust(rng, i):
    p = [rng.choice([f"{rng.random():.3f}", f"{10 ** rng.uniform(-250, 0):.6e}", "0.04", "1", "0"]) for _ in range(rng.randint(1, 40))]
    c = Checks()
    p_adjust([Q(x) for x in p], c)
    return "p_adjust", ["p", *p], c, {}


def draw_power(rng, i):
    lines, c = ["test,n,effect,alpha,k,corr,epsilon"], Checks()
    for row in range(6):
        test, alpha = rng.choice(["paired_t", "pearson", "rm_anova"]), rng.choice([0.05, 0.01, 0.001])
        k = rng.randint(2, 6)
        n, corr, eps = rng.randint(5, 80), round(rng.uniform(0, 0.9), 2), round(rng.uniform(1 / (k - 1) + 0.001, 1), 2) if k > 2 else 1.0
        effect = round(rng.uniform(0.05, 0.9) if test != "rm_anova" else rng.uniform(0.01, 0.3), 3)
        tail = f"{k},{corr},{eps}" if test == "rm_anova" else ",,"
        lines.append(f"{test},{n},{effect},{alpha},{tail}")
        args = (effect, alpha, k, corr, eps)
        c.put(f"row.{row}.power", power_of(test, n, *args), (1e-6, 1e-9))
        need = next((m for m in range(4, 4000) if power_of(test, m, *args) >= 0.8), None)
        if need and need > 4:
            c.put(f"row.{row}.n_for_80", need, EXACT)
    return "power", lines, c, {}


def draw_reported(rng, i):
    lines, c = ["coefficient,df,p"], Checks()
    for row in range(8):
        df, places = rng.randint(3, 200), rng.choice([2, 2, 3])
        r = round(rng.uniform(-0.99, 0.99), places)
        half = 0.5 * 10.0 ** -places
        text = f"{r:.{places}f}".replace("0.", ".")
        exact = p_r(mp.mpf(str(r)), df)
        low, high = p_r(mp.mpf(str(min(1, abs(r) + half))), df), p_r(mp.mpf(str(max(0, abs(r) - half))), df)
        kind = rng.randrange(3)
        if kind == 0:
            lines.append(f"{text},{df},<.001")
            ok = low < 0.001
        else:
            shown = round(float(exact) * (1 if kind == 1 else 10), 3)
            if shown > 1 or shown == 0:
                shown = 0.5
            lines.append(f"{text},{df},={shown:.3f}".replace("=0.", "=."))
            ok = low <= mp.mpf(str(shown)) + mp.mpf("0.0005") and high >= mp.mpf(str(shown)) - mp.mpf("0.0005")
        c[f"row.{row}"] = {"p": float(exact), "consistent": bool(ok), "rel_tol": 1e-8}
    return "reported", lines, c, {}


DRAW = [draw_within] * 5 + [draw_correlation] * 2 + [draw_rm_corr, draw_items, draw_sample, draw_between, draw_p_adjust, draw_power, draw_reported]

# The program's calls.
CALLS = {
    "within": ["within", "--subject", "subject", "--within", "condition", "--value", "value"],
    "correlation": ["correlate", "--x", "x", "--y", "y", "--method", "all"],
    "rm_corr": ["rmcorr", "--subject", "subject", "--x", "x", "--y", "y"],
    "sample": ["normality", "--value", "value"], "between": ["levene", "--group", "group", "--value", "value"],
    "p_adjust": ["adjust", "--p", "p"], "power": ["power"], "reported": ["recheck"],
}


def flat(value, path=""):
    pairs = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else None
    if pairs is None:
        yield path, value
        return
    for key, inner in pairs:
        yield from flat(inner, f"{path}.{key}" if path else str(key))


def compare(program, folder, case):
    """What the program says otherwise, one line a name."""
    design = case["design"]
    data = folder / "data.csv"
    words = CALLS.get(design) or ["alpha", "--items", data.read_text().splitlines()[0]]
    run = subprocess.run([program, "stats", words[0], str(data), *words[1:], "--format", "json"], capture_output=True, text=True, timeout=120)
    if run.returncode:
        said = run.stderr.strip().replace("\n", " ")
        fine = run.returncode == 1 and said and "panicked" not in said and all(w.get("undefined") or n in ("n", "k") for n, w in case["checks"].items())
        return [] if fine else [f"exit {run.returncode}: {said[:200]}"]
    answer = json.loads(run.stdout)
    reasons = answer.pop("undefined", None) or {}
    got, wrong = dict(flat(answer)), []
    for name, want in case["checks"].items():
        if "consistent" in want:
            good = got.get(name + ".consistent") is want["consistent"] and math.isclose(got.get(name + ".p") or -1, want["p"], rel_tol=1e-6)
            if not good:
                wrong.append(f"{name}: want {want}, got {got.get(name + '.p')}, {got.get(name + '.consistent')}")
            continue
        have = got.get(name)
        if want.get("undefined"):
            said = any(name == key or name.startswith(key + ".") for key in reasons)
            if have is not None or not said:
                wrong.append(f"{name}: has no value; got {have}, reason {said}")
        elif not isinstance(have, (int, float)):
            wrong.append(f"{name}: want {want['value']}, got {have}, {reasons.get(name)}")
        elif abs(have - want["value"]) > max(want.get("abs_tol", 0), want.get("rel_tol", 0) * abs(want["value"])):
            wrong.append(f"{name}: want {want['value']}, got {have}")
    return wrong


def main():
    ap = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    ap.add_argument("--out", type=pathlib.Path, required=True)
    ap.add_argument("--cases", type=int, default=300)
    ap.add_argument("--seed", type=int, default=1)
    ap.add_argument("--bin")
    args = ap.parse_args()
    seen, checks, wrong = Counter(), 0, 0
    for i in range(args.cases):
        rng = random.Random(f"{args.seed}-{i}")
        draw = DRAW[i % len(DRAW)]
        design, lines, found, more = draw(rng, rng.randrange(10_000))
        folder = args.out / f"{args.seed}-{i:04}-{design}"
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "data.csv").write_text("\n".join(lines) + "\n")
        case = {"case": folder.name, "design": design, **more, "checks": found}
        (folder / "expected.json").write_text(json.dumps(case, indent=1))
        seen[design] += 1
        checks += len(found)
        if args.bin:
            faults = compare(args.bin, folder, case)
            wrong += len(faults)
            for fault in faults[:8]:
                print(f"{folder.name}: {fault}", flush=True)
    print(f"{sum(seen.values())} cases ({', '.join(f'{d} {c}' for d, c in seen.items())}), {checks} numbers", end="")
    print(f", {wrong} differ" if args.bin else "")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
