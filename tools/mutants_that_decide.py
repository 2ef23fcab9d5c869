#!/usr/bin/env python3
"""Mutants of the code that decides a verdict, a p, an interval or who is left out: does a test of the program catch each?

    python3 tools/mutants_that_decide.py --number 30 --seed 1 > mutants.md

Works on a clean checkout and leaves it as it was. Of each mutant first the tests of its own crate run, then those of every crate that uses it.
A mutant that does not compile is none, and another is drawn. Prints a table, a row a mutant: where, what was changed, which test failed.
"""
import argparse, json, pathlib, random, re, subprocess, sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
# What decides: crate → files below its `src`.
DECIDES = {
    "analysis": ["verdict.rs", "finding.rs", "findings/*.rs", "exclusions.rs", "flow.rs", "compare.rs", "contrast.rs", "hypotheses.rs", "reproduction.rs",
                 "line.rs", "homophily.rs", "congruence.rs", "data.rs", "data/*.rs", "design_test.rs", "correlations.rs", "primary.rs", "planned.rs",
                 "presses.rs", "retest.rs", "sensitivity.rs", "which.rs", "by_factor.rs", "family.rs", "recommendation/*.rs"],
    "rehearsal": ["findings.rs", "rates.rs", "power.rs", "leave_out/*.rs"],
    "stats": ["adjust.rs", "equivalence.rs", "proportion.rs", "by_design/*.rs", "compare/*.rs", "paired/*.rs", "friedman/*.rs", "groups/*.rs", "rm_anova.rs",
              "case_crossover.rs", "event_rates.rs", "forced_choice.rs", "mcnemar.rs", "cochran_q.rs", "mixed/congruence.rs", "mixed/ratio.rs"],
    "study": ["gate.rs", "missing.rs", "missing/*.rs", "stages/evaluate/findings.rs"],
}
CHANGES = [
    (r" < ", " > "), (r" > ", " < "), (r" <= ", " > "), (r" >= ", " < "), (r" == ", " != "), (r" != ", " == "), (r" && ", " || "), (r" \|\| ", " && "),
    (r" \+ ", " - "), (r" - ", " + "), (r" \* ", " / "), (r"\bPlus\b", "Minus"), (r"\bMinus\b", "Plus"), (r"\.holm\b", ".bh"), (r"\bp_holm\b", "p"),
    (r"\blow\b", "high"), (r"\bhigh\b", "low"), (r"\bfirst\b", "second"), (r"\bsecond\b", "first"), (r"\bmin\b", "max"), (r"\bmax\b", "min"),
    (r"\btrue\b", "false"), (r"\bfalse\b", "true"), (r"\.all\(", ".any("), (r"\.any\(", ".all("), (r"\bEvery\b", "One"), (r"\bevery\(", "one("),
]


def candidates():
    found = []
    for crate, patterns in DECIDES.items():
        for pattern in patterns:
            files = sorted((ROOT / "crates" / crate / "src").glob(pattern))
            if not files:
                sys.exit(f"{crate} has no file {pattern}: DECIDES in this script is out of date")
            for file in files:
                if file.stem in ("tests", "testing"):
                    continue
                # Texts decide nothing, however many lines they have.
                hidden = re.sub(r'//[^\n]*|"(?:[^"\\]|\\.)*"', lambda m: re.sub(r"[^\n]", "\0", m.group()), file.read_text(), flags=re.S)
                for number, (line, code) in enumerate(zip(file.read_text().split("\n"), hidden.split("\n"))):
                    if line.strip() == "#[cfg(test)]":
                        break
                    if re.match(r"\s*(//|#|use |pub use |mod |pub mod |fn |pub fn |pub\(crate\) fn |pub struct |struct |impl|pub [a-z_]+:)", line):
                        continue
                    for pattern_of, new in CHANGES:
                        for match in re.finditer(pattern_of, code):
                            found.append((crate, file, number, match.span(), new))
    return found


def dependents(crate):
    packages = json.loads(subprocess.run(["cargo", "metadata", "--format-version", "1", "--no-deps"], cwd=ROOT, capture_output=True, check=True).stdout)["packages"]
    uses = {p["name"]: {d["name"] for d in p["dependencies"]} for p in packages}
    all_of, new = set(), {f"maveric-{crate}"}
    while new:
        all_of |= new
        new = {name for name, used in uses.items() if used & all_of} - all_of
    # The wheel needs Python; what it calls is tested below it.
    return sorted(all_of - {f"maveric-{crate}", "maveric-python"})


def test(packages, limit):
    command = ["cargo", "test", "--quiet", "--no-fail-fast", "--lib", "--bins", "--tests"]
    for package in packages:
        command += ["-p", package]
    try:
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=limit)
    except subprocess.TimeoutExpired:
        return "caught", "it runs for ever"
    text = done.stdout + done.stderr
    if done.returncode == 0:
        return "survived", ""
    failed = re.findall(r"^---- (.+?) stdout ----$", text, re.M)
    if not failed and re.search(r"^error(\[E\d+\])?: (?!test failed|\d+ targets? failed)", text, re.M):
        return "not compiled", ""
    return "caught", failed[0] if failed else "a process that failed"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--number", type=int, default=30)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--crate", help="of this crate alone")
    parser.add_argument("--limit", type=int, default=1800, help="seconds for the tests of one step")
    given = parser.parse_args()
    if subprocess.run(["git", "status", "--porcelain", "--untracked-files=no"], cwd=ROOT, capture_output=True, text=True).stdout.strip():
        sys.exit("the checkout has changes: commit them first")
    drawn = [c for c in candidates() if given.crate in (None, c[0])]
    random.Random(given.seed).shuffle(drawn)
    print("| where | changed | caught by |\n|---|---|---|", flush=True)
    made = caught = 0
    for crate, file, number, (start, end), new in drawn:
        if made == given.number:
            break
        before = file.read_text()
        lines = before.split("\n")
        old = lines[number]
        lines[number] = old[:start] + new + old[end:]
        try:
            file.write_text("\n".join(lines))
            # Beside the program, so that polars is not compiled anew.
            own = [f"maveric-{crate}"] + ["maveric-cli"] * (crate == "study")
            outcome, by = test(own, given.limit)
            if outcome == "survived":
                outcome, by = test(dependents(crate), given.limit)
        finally:
            file.write_text(before)
        if outcome == "not compiled":
            continue
        made += 1
        caught += outcome == "caught"
        shown = lines[number].strip().replace("|", "\\|")
        print(f"| `{file.relative_to(ROOT / 'crates')}:{number + 1}` | `{shown}` (was `{old[start:end].strip()}`) | {by or '**nobody**'} |".replace("`|", "`\\|"), flush=True)
    print(f"\n{caught} of {made} caught")


main()
