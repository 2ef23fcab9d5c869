#!/usr/bin/env python3
"""Feeds damaged tables to `maveric stats` and watches how it answers.

usage: stats_fuzz.py --bin target/release/maveric [--minutes 10] [--seed 1] [--keep DIR]

Each run starts from a good table, damages it (bytes turned, lines doubled, cut, shuffled, cells replaced by odd numbers and
texts), and calls a command on it, by file or on standard input. Right is: exit 0 with one JSON object without NaN or infinity in
which every null has a reason, or exit 1 with a message on stderr and nothing on stdout; never a panic, another status, or more
than 30 seconds. Tables that fail are kept in DIR.
"""
import argparse, json, math, pathlib, random, subprocess, sys, tempfile, time
from collections import Counter

ODD = ["", "NaN", "inf", "-inf", "1e400", "-0", "0x10", "1,5", "1e308", "1e-320", "text", "\"", "\"\"", "'", " 7 ", "NA", "null", "None", "९", "1_000", "٣",
       "1e75", "-1e76", "0.1", "0.30000000000000004", "9007199254740993", "\u00a03", "\ufeff1", "true", "2020-01-01", "a\"b", "|", ".", "1e", "+5", "−5"]
WITHIN = ["--subject", "subject", "--within", "condition", "--value", "value"]
CALLS = [
    ["within", *WITHIN], ["compare", *WITHIN], ["friedman", *WITHIN], ["rm-anova", *WITHIN],
    ["posthoc", *WITHIN, "--test", "wilcoxon"], ["posthoc", *WITHIN, "--test", "nemenyi"],
    ["normality", "--value", "value", "--group", "condition"], ["levene", "--group", "condition", "--value", "value"],
    ["correlate", "--x", "x", "--y", "value", "--method", "all"], ["rmcorr", "--subject", "subject", "--x", "x", "--y", "value"],
    ["alpha", "--items", "x,value"], ["adjust", "--p", "x"], ["power"], ["recheck"],
    ["bootstrap", "--statistic", "eta2_partial", *WITHIN, "--resamples", "200"],
    ["bootstrap", "--statistic", "pearson", "--x", "x", "--y", "value", "--resamples", "200"],
]


def good(rng):
    n, k = rng.randint(1, 8), rng.randint(1, 4)
    write = rng.choice([lambda v: f"{v:.2f}", lambda v: str(round(v)), repr, lambda v: "3"])
    rows = ["subject,condition,value,x"]
    for s in range(n):
        rows += [f"P{s},c{j},{write(rng.gauss(5, 2))},{write(rng.random())}" for j in range(k)]
    return "\n".join(rows) + "\n"


def damaged(rng, text):
    data = text
    for _ in range(rng.choice([0, 1, 1, 2, 3, 8])):
        lines = data.split("\n")
        row = rng.randrange(len(lines))
        cells = lines[row].split(",")
        what = rng.randrange(9)
        if what <= 2:
            cells[rng.randrange(len(cells))] = rng.choice(ODD)
            lines[row] = ",".join(cells)
        elif what == 3:
            lines.insert(row, lines[rng.randrange(len(lines))])
        elif what == 4:
            del lines[row]
        elif what == 5:
            lines[row] = ",".join(cells[: rng.randrange(len(cells) + 1)] + [rng.choice(ODD)] * rng.randrange(3))
        elif what == 6:
            rng.shuffle(lines)
        elif what == 7:
            return data.replace("\n", rng.choice(["\r\n", "\r", "\n\n"])).replace(",", rng.choice([",", ";", "\t", ", "]))
        else:
            raw = bytearray(data.encode("utf-8", "surrogatepass"))
            for _ in range(rng.randint(1, 4)):
                if raw:
                    raw[rng.randrange(len(raw))] = rng.randrange(256)
            return bytes(raw)
        data = "\n".join(lines)
    return data


def nulls(value, path=""):
    if isinstance(value, dict):
        for key, inner in value.items():
            if key != "undefined" or path:
                yield from nulls(inner, f"{path}.{key}" if path else key)
    elif isinstance(value, list):
        for i, inner in enumerate(value):
            yield from nulls(inner, f"{path}.{i}")
    elif value is None or isinstance(value, float) and not math.isfinite(value):
        yield path, value


def fault(run, call):
    if run.returncode == 1:
        said = run.stderr.decode("utf-8", "replace")
        if "panicked" in said or "RUST_BACKTRACE" in said:
            return "panic: " + said[:300]
        return None if said.strip() and not run.stdout else "exit 1 without a message, or with output"
    if run.returncode != 0:
        return f"exit {run.returncode}: {run.stderr[:300]!r}"
    try:
        answer = json.loads(run.stdout)
    except ValueError as error:
        return f"no JSON: {error}"
    reasons = answer.get("undefined") or {}
    if call[0] == "normality":
        return None  # groups carry their own reasons
    for name, value in nulls(answer):
        if value is not None or not any(name == key or name.startswith(key + ".") for key in reasons):
            return f"{name} = {value} without a reason"
    return None


def main():
    ap = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    ap.add_argument("--bin", required=True)
    ap.add_argument("--minutes", type=float, default=10)
    ap.add_argument("--seed", type=int, default=1)
    ap.add_argument("--keep", type=pathlib.Path, default=pathlib.Path("fuzz-kept"))
    args = ap.parse_args()
    rng, ends, seen, faults = random.Random(args.seed), time.monotonic() + 60 * args.minutes, Counter(), Counter()
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "data.csv"
        while time.monotonic() < ends:
            data = damaged(rng, good(rng))
            data = data.encode("utf-8", "surrogatepass") if isinstance(data, str) else data
            call, piped = rng.choice(CALLS), rng.random() < 0.3
            path.write_bytes(data)
            words = [args.bin, "stats", call[0], "-" if piped else str(path), *call[1:], "--format", "json"]
            try:
                run = subprocess.run(words, input=data if piped else b"", capture_output=True, timeout=30)
                found = fault(run, call)
                seen[f"exit {run.returncode}"] += 1
            except subprocess.TimeoutExpired:
                found = "more than 30 seconds"
            if found:
                faults[found[:60]] += 1
                if faults[found[:60]] <= 3:
                    args.keep.mkdir(parents=True, exist_ok=True)
                    kept = args.keep / f"{args.seed}-{sum(seen.values())}.csv"
                    kept.write_bytes(data)
                    print(f"{kept}: {' '.join(call)}: {found}", flush=True)
    print(f"{sum(seen.values())} tables: {dict(seen)}; {sum(faults.values())} faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
