"""Every reference case of the statistics, through Python: numbers that other programs and 60-digit arithmetic gave."""

import csv
import json
import math
import os
import re
from pathlib import Path

import polars
import pytest

import maveric
from maveric import stats

CASES = Path(os.environ.get("MAVERIC_CASES") or Path(__file__).resolve().parents[2] / "stats/tests/oracle")
FOLDERS = sorted(p.parent for p in CASES.glob("*/expected.json"))
# Checks that quote a program where the number does not exist: the crate's own test lists them, with the reason.
LISTED = CASES.parent / "oracle.rs"
NO_SUCH_NUMBER = set(re.findall(r'\(\s*"(\w+)",\s*"([\w.]+)",\s*"', LISTED.read_text() if LISTED.exists() else ""))
WITHIN = {"subject": "subject", "within": "condition", "value": "value"}


def calls(case, columns):
    """(prefix of the names that this call answers or None, function, its arguments)"""
    design = case["design"]
    if design == "within":
        return [(None, stats.within, WITHIN)]
    if design == "correlation":
        return [(None, stats.correlate, {"x": "x", "y": "y", "method": "all"})]
    if design == "rm_corr":
        return [(None, stats.rmcorr, {"subject": "subject", "x": "x", "y": "y"})]
    if design == "items":
        return [(None, stats.alpha, {"items": columns})]
    if design == "sample":
        return [(None, stats.normality, {"value": "value"})]
    if design == "between":
        return [(None, stats.levene, {"group": "group", "value": "value"})]
    if design == "p_adjust":
        return [(None, stats.adjust, {"p": "p"})]
    if design == "power":
        return [(None, stats.power, {})]
    if design == "reported":
        return [(None, stats.recheck, {})]
    if design == "bootstrap":
        words = case["statistic"].lower()
        of = {"statistic": "pearson", "x": "x", "y": "y"} if "pearson" in words else {"statistic": "mean", "value": "value"}
        return [(None, stats.bootstrap, {**of, "resamples": 50_000, "seed": 7})]
    if design == "factorial":
        of = {"subject": "subject", "value": "value", "within": case["within"] or None, "between": case["between"] or None}
        return [(None, stats.factorial, of), ("art.", stats.factorial, {**of, "method": "art"})]
    if design == "by_design":
        products = [f"{covariate}:{effect}" for covariate, effects in case["covariates"].items() for effect in effects]
        of = {"subject": "subject", "value": "value", "within": case["within"], "between": case["between"] or None}
        return [(None, stats.compare, {**of, "covariate": list(case["covariates"]), "with_": products})]
    if design == "groups":
        return [(None, stats.groups, {"group": "group", "value": "value"})]
    if design == "equivalence":
        of = WITHIN if case["kind"] == "paired" else {"value": "value", "mu": case["mu"]}
        return [(None, stats.equivalence, {**of, "bounds": tuple(case["bounds"]), "standardized": case["standardized"]})]
    if design == "bayes":
        kinds = {"paired": WITHIN, "two": {"group": "group", "value": "value"}, "correlation": {"x": "x", "y": "y"}}
        return [(None, stats.bayes, kinds.get(case["kind"]) or {"value": "value", "mu": case.get("mu", 0)})]
    if design == "mixed":
        return [(None, stats.mixed, {"subject": "subject", "fixed": case["fixed"], "value": "value"})]
    assert design == "ordinal", design
    return [(None, stats.ordinal, WITHIN)]


def flat(value, path=""):
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else None
    if items is None:
        yield path, value
        return
    for key, inner in items:
        yield from flat(inner, f"{path}.{key}" if path else str(key))


def wrong(name, want, got, reasons, refused):
    """None where the check holds, else what is wrong."""
    if want.get("undefined"):
        why = any(name == k or name.startswith(k + ".") for k, v in reasons.items() if v)
        return None if refused or (got.get(name) is None and why) else f"{name} should have no value, and a reason"
    if refused:
        return f"{name}: refused: {refused}"
    if "consistent" in want:
        same = got.get(name + ".consistent") is want["consistent"]
        return None if same and math.isclose(got[name + ".p"], want["p"], rel_tol=1e-6) else f"{name}: {want}"
    have, value = got.get(name), want.get("value")
    if isinstance(value, list):
        have = [v for k, v in got.items() if k.rpartition(".")[0] == name and k.rpartition(".")[2].isdigit()]
        return None if sorted(map(str, have)) == sorted(map(str, value)) else f"{name}: {have} for {value}"
    if isinstance(value, (bool, str)):
        return None if have == value else f"{name}: {have} for {value}"
    if not isinstance(have, (int, float)):
        return f"{name}: {have!r} for {want}"
    if "accept" in want:
        low, high = want["accept"]
        return None if low <= have <= high else f"{name}: {have} not in {want['accept']}"
    near = max(want.get("abs_tol", 0.0), want.get("rel_tol", 0.0) * abs(value))
    return None if abs(have - value) <= near else f"{name}: {have} for {value}"


def tables(path):
    """The table as text in lists, and as a frame whose types polars chose."""
    with path.open(newline="") as file:
        rows = list(csv.DictReader(file))
    plain = {name: [row[name] for row in rows] for name in rows[0]}
    return plain, polars.read_csv(path, null_values=["NA", ""], infer_schema_length=None)


def test_the_cases_are_there():
    if not CASES.is_dir():
        pytest.skip(f"no reference cases: {CASES} is not there")
    assert len(FOLDERS) > 25


@pytest.mark.parametrize("folder", FOLDERS, ids=lambda p: p.name)
def test_a_case_has_the_reference_numbers(folder):
    case = json.loads((folder / "expected.json").read_text())
    if case["design"] == "mixed" and ("random" in case or "by" in case):
        pytest.skip("a mixed model with more than a random intercept is part of the crate; no command fits it alone")
    if case["design"] == "crossover":
        pytest.skip("the place of a ride in its order comes with a study; no command of statistics takes it alone")
    if case["design"] in ("case_crossover", "event_rates"):
        pytest.skip("presses and their moments come with a study; no command of statistics takes them alone")
    plain, frame = tables(folder / case.get("data", "data.csv"))
    parts = []
    for prefix, function, words in calls(case, list(plain)):
        answers = []
        for table in [plain] if case["design"] == "reported" else [plain, frame]:
            try:
                answers.append(function(table, **words).to_dict())
            except maveric.Error as error:
                answers.append(str(error))
        if isinstance(answers[0], dict):
            assert answers[0] == answers[-1], "a frame of numbers gives what text gives"
        refused = answers[0] if isinstance(answers[0], str) else None
        answer = {} if refused else answers[0]
        got = dict(flat({k: v for k, v in answer.items() if k != "undefined"}))
        parts.append((prefix, refused, got, answer.get("undefined") or {}))
    checked, problems = 0, []
    for name, want in case["checks"].items():
        if not {"value", "accept", "undefined", "consistent"} & want.keys():
            continue
        if (folder.name, name) in NO_SUCH_NUMBER:
            want = {"undefined": True}
        part = next((p for p in parts if p[0] and name.startswith(p[0])), parts[0])
        checked += 1
        problem = wrong(name, want, part[2], part[3], part[1])
        problems += [problem] if problem else []
    assert checked and not problems, "\n".join(problems[:10])
