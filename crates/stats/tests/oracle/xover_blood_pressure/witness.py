"""Writes expected.json of the three published crossovers: xover_milk, xover_blood_pressure and xover_plaque.

    python witness.py        (numpy, scipy; statsmodels looks at the same)

Nothing is shared with the crate: columns are written out, the restricted likelihood is that of the dense covariance of all rows, its
curvature and the slopes of the covariance of the coefficients are differences.
"""
import csv
import itertools
import json
import pathlib

import numpy as np
from scipy import optimize, stats
import statsmodels.api as sm

HERE = pathlib.Path(__file__).parent.parent


def table(case):
    return list(csv.DictReader((HERE / case / "data.csv").open()))


def levels(cells):
    return list(dict.fromkeys(cell for cell in cells if cell))


class Fit:
    """Random intercept of the subject by restricted maximum likelihood."""

    def __init__(self, rows, terms):
        self.y = np.array([float(r["value"]) for r in rows])
        who = [r["subject"] for r in rows]
        people = levels(who)
        self.z = np.array([[float(w == p) for p in people] for w in who])
        self.names, columns, self.at = ["(Intercept)"], [np.ones(len(rows))], {}
        for term, cells, zero_sum in terms:
            found = levels(cells)
            self.at[term] = (found, zero_sum, len(columns))
            for level in found[:-1] if zero_sum else found[1:]:
                minus = found[-1] if zero_sum else None
                columns.append(np.array([float(c == level) - float(bool(c) and c == minus) for c in cells]))
                self.names.append(f"{term}[{level}]")
        self.x = np.array(columns).T
        start = np.log([self.y.var() / 2, self.y.var() / 2])
        top = optimize.minimize(lambda t: -self.loglik(np.exp(t)), start, method="Nelder-Mead",
                                options=dict(xatol=1e-13, fatol=1e-13, maxiter=20000, maxfev=20000))
        self.theta = np.exp(top.x)
        self.c = self.covariance(self.theta)
        v = np.linalg.inv(self.v(self.theta))
        self.beta = self.c @ self.x.T @ v @ self.y
        h = 1e-3 * self.theta
        curve = np.zeros((2, 2))
        for i, j in itertools.product(range(2), range(2)):
            def at(a, b):
                t = self.theta.copy()
                t[i] += a * h[i]
                t[j] += b * h[j]
                return -self.loglik(t)
            curve[i, j] = (at(1, 1) - at(1, -1) - at(-1, 1) + at(-1, -1)) / (4 * h[i] * h[j])
        self.inverse = np.linalg.inv(curve)

    def v(self, theta):
        return theta[0] * self.z @ self.z.T + theta[1] * np.eye(len(self.y))

    def covariance(self, theta):
        return np.linalg.inv(self.x.T @ np.linalg.solve(self.v(theta), self.x))

    def loglik(self, theta):
        v = self.v(theta)
        inverse = np.linalg.inv(v)
        xx = self.x.T @ inverse @ self.x
        beta = np.linalg.solve(xx, self.x.T @ inverse @ self.y)
        rest = self.y - self.x @ beta
        n, p = self.x.shape
        dets = np.linalg.slogdet(v)[1] + np.linalg.slogdet(xx)[1]
        return -0.5 * (dets + rest @ inverse @ rest + (n - p) * np.log(2 * np.pi))

    def df(self, l):
        slopes = []
        for k in range(2):
            h = 1e-5 * self.theta[k]
            up, down = self.theta.copy(), self.theta.copy()
            up[k] += h
            down[k] -= h
            slopes.append(l @ (self.covariance(up) - self.covariance(down)) @ l / (2 * h))
        g = np.array(slopes)
        return 2 * (l @ self.c @ l) ** 2 / (g @ self.inverse @ g)

    def weights(self, term, of):
        """Coefficients of a sum of levels of a term."""
        found, zero_sum, first = self.at[term]
        l = np.zeros(len(self.names))
        for level, weight in of.items():
            at = found.index(level)
            if zero_sum and at == len(found) - 1:
                l[first:first + at] -= weight
            elif zero_sum:
                l[first + at] += weight
            elif at > 0:
                l[first + at - 1] += weight
        return l

    def test(self, l):
        estimate, se, df = l @ self.beta, np.sqrt(l @ self.c @ l), self.df(l)
        return dict(estimate=estimate, se=se, df=df, p=2 * stats.t.sf(abs(estimate / se), df))

    def term(self, term):
        """Wald's F; degrees of freedom by Fai and Cornelius."""
        found, zero_sum, first = self.at[term]
        k = len(found)
        helmert = np.array([[1.0 / np.sqrt(i * (i + 1)) if j < i else -i / np.sqrt(i * (i + 1)) if j == i else 0.0
                             for j in range(k)] for i in range(1, k)])
        rows = np.array([self.weights(term, dict(zip(found, r))) for r in helmert])
        values, vectors = np.linalg.eigh(rows @ self.c @ rows.T)
        axes = vectors.T @ rows
        q = len(rows)
        f = sum((a @ self.beta) ** 2 / v for a, v in zip(axes, values)) / q
        dfs = np.array([self.df(a) for a in axes])
        if np.allclose(dfs, dfs[0], rtol=1e-6):
            df = dfs[0]
        else:
            e = sum(d / (d - 2) for d in dfs)
            df = 2 * e / (e - q)
        return dict(F=f, df1=q, df2=df, p=stats.f.sf(f, q, df))

    def statsmodels(self):
        groups = self.z.argmax(axis=1)
        found = sm.MixedLM(self.y, self.x, groups).fit(reml=True)
        assert np.allclose(found.fe_params, self.beta, rtol=1e-3, atol=1e-3), (found.fe_params, self.beta)
        se = np.sqrt(np.diag(self.c))
        # Its optimiser stops early in the variance of the subjects.
        assert np.allclose(found.bse_fe, se, rtol=1e-2), (found.bse_fe / se, found.scale / self.theta[1])
        assert np.isclose(found.scale, self.theta[1], rtol=1e-3)


def fixed_people_ratio(rows, condition, period, before):
    """Variance of a difference of two conditions with carry-over over that without, people fixed, mean over the pairs."""
    people = levels(r["subject"] for r in rows)

    def mean(zero_sum):
        columns = [[float(r["subject"] == p) for r in rows] for p in people]
        for level in levels(period)[1:]:
            columns.append([float(c == level) for c in period])
        if zero_sum:
            found = levels(before)
            for level in found[:-1]:
                columns.append([float(c == level) - float(c == found[-1]) for c in before])
        start = len(columns)
        found = levels(condition)
        for level in found[1:]:
            columns.append([float(c == level) for c in condition])
        x = np.array(columns).T
        c = np.linalg.inv(x.T @ x)
        e = [np.zeros(len(c))] + [np.eye(len(c))[start + i] for i in range(len(found) - 1)]
        pairs = [(a - b) @ c @ (a - b) for a, b in itertools.combinations(e, 2)]
        return sum(pairs) / len(pairs)
    return mean(True) / mean(False)


SOURCE = {
    "xover_milk": ("milk of six cows on three diets, two Latin squares",
                   "Cochran and Cox (1957), p. 135; Ratkowsky, Evans and Alldredge (1992), table 1.1; typed from cow_1.csv of the R package xover"),
    "xover_blood_pressure": ("blood pressure of twelve people after three treatments, two people an order",
                             "blood_pressure.csv of the R package xover, whose data are those of books on crossovers: mean of the eight readings after each treatment"),
    "xover_plaque": ("plaque of 34 people in two periods", "plaque.csv of the R package xover, whose data are those of books on crossovers"),
}
TOLERANCE = {"estimate": 1e-6, "se": 1e-5, "df": 1e-3, "df2": 1e-3, "F": 1e-5, "p": 2e-3, "df1": 0, "variance_ratio": 1e-10}


def write(case, design, numbers, more):
    checks = {}
    for path, value in numbers.items():
        kind = path.rsplit(".", 1)[-1]
        small = 1e-6 if kind == "estimate" else 1e-12
        checks[path] = {"value": float(value) if kind != "df1" else int(value), "rel_tol": TOLERANCE[kind], "abs_tol": small if kind != "df1" else 0.0, "from": "c1"}
    title, source = SOURCE[case]
    whole = {"case": case, "title": title, "source": source, "design": design, "data": "data.csv", **more,
             "calls": {"c1": "xover_blood_pressure/witness.py: numpy and scipy, dense restricted likelihood; estimates and errors held against statsmodels MixedLM(reml=True) there, within 1 %"},
             "checks": checks}
    text = json.dumps(whole, indent=1)
    (HERE / case / "expected.json").write_text(text + "\n")


def flat(prefix, numbers):
    return {f"{prefix}.{key}": value for key, value in numbers.items()}


def milk():
    rows = table("xover_milk")
    cells = {name: [r[name] for r in rows] for name in ("diet", "period", "before")}
    fit = Fit(rows, [("diet", cells["diet"], False), ("period", cells["period"], False), ("before", cells["before"], True)])
    fit.statsmodels()
    found = {}
    for term in ("diet", "period", "before"):
        found |= flat(f"anova.{term}", fit.term(term))
    for level in levels(cells["before"]):
        found |= flat(f"coef.before[{level}]", fit.test(fit.weights("before", {level: 1.0})))
    for a, b in itertools.combinations(levels(cells["diet"]), 2):
        found |= flat(f"contrast.diet.{a}|{b}", fit.test(fit.weights("diet", {a: 1.0, b: -1.0})))
    write("xover_milk", "mixed", found, {"fixed": "diet + period + before", "by": ["diet"], "sum_to_zero": ["before"]})


def crossover(case):
    rows = table(case)
    condition, period = [[r[name] for r in rows] for name in ("condition", "period")]
    met = {(r["subject"], int(r["period"])): r["condition"] for r in rows}
    before = [met.get((r["subject"], int(r["period"]) - 1), "") for r in rows]
    terms = [("condition", condition, False), ("period", period, False)]
    fit = Fit(rows, terms)
    fit.statsmodels()
    found = {}
    for term in ("condition", "period"):
        found |= flat(f"by_design.anova.{term}", fit.term(term))
    pairs = list(itertools.combinations(levels(condition), 2))
    for a, b in pairs:
        found |= flat(f"by_design.contrast.condition.{a}|{b}", fit.test(fit.weights("condition", {a: 1.0, b: -1.0})))
    if len(levels(condition)) > 2:
        carried = Fit(rows, terms + [("carry_over", before, True)])
        carried.statsmodels()
        found |= flat("carry_over.test", carried.term("carry_over"))
        for level in levels(before):
            found |= flat(f"carry_over.effects.{level}", carried.test(carried.weights("carry_over", {level: 1.0})))
        for a, b in pairs:
            found |= flat(f"carry_over.contrast.{a}|{b}", carried.test(carried.weights("condition", {a: 1.0, b: -1.0})))
        found["carry_over.variance_ratio"] = fixed_people_ratio(rows, condition, period, before)
    else:
        # By hand: half the difference of the mean differences of both orders, t with n - 2.
        first = levels(condition)[0]
        d = {True: [], False: []}
        for who in levels(r["subject"] for r in rows):
            values = {r["condition"]: float(r["value"]) for r in rows if r["subject"] == who}
            a, b = levels(condition)
            d[met[(who, 1)] == first].append(values[a] - values[b])
        one, two = map(np.array, (d[True], d[False]))
        n = len(one) + len(two)
        pooled = (((one - one.mean()) ** 2).sum() + ((two - two.mean()) ** 2).sum()) / (n - 2)
        se = 0.5 * np.sqrt(pooled * (1 / len(one) + 1 / len(two)))
        estimate = 0.5 * (one.mean() + two.mean())
        a, b = pairs[0]
        model = fit.test(fit.weights("condition", {a: 1.0, b: -1.0}))
        assert np.isclose(model["estimate"], estimate, rtol=1e-6) and np.isclose(model["se"], se, rtol=1e-5), (model, estimate, se)
        assert np.isclose(model["df"], n - 2, rtol=1e-3), model
    write(case, "crossover", found, {})


milk()
crossover("xover_blood_pressure")
crossover("xover_plaque")
