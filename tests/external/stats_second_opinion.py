"""The numbers of `maveric stats`, a second time: sums in exact fractions, functions with 50 digits, exact p values counted.

Only Shapiro-Wilk, noncentral F and the numbers named after SciPy come from SciPy itself.
"""
import itertools, math
from collections import Counter, defaultdict
from fractions import Fraction as Q

import mpmath as mp
import numpy as np
import scipy.optimize as opt
import scipy.stats as st

mp.mp.dps = 50
EXACT, NUMBER, P, INTERVAL, LOOSE = (0, 0), (1e-9, 1e-12), (1e-8, 1e-40), (1e-6, 1e-7), (1e-5, 1e-8)


def real(q):
    return mp.mpf(q.numerator) / q.denominator if isinstance(q, Q) else mp.mpf(q)


# Distributions.
def t_two_sided(t, df):
    t, df = real(t), real(df)
    return mp.betainc(df / 2, mp.mpf(1) / 2, 0, df / (df + t * t), regularized=True)


def f_upper(f, d1, d2):
    f, d1, d2 = real(f), real(d1), real(d2)
    return mp.betainc(d2 / 2, d1 / 2, 0, d2 / (d2 + d1 * f), regularized=True)


def chi2_upper(x, df):
    return mp.gammainc(real(df) / 2, real(x) / 2, mp.inf, regularized=True)


def normal_two_sided(z):
    return mp.erfc(abs(real(z)) / mp.sqrt(2))


def t_quantile(df):
    guess = float(st.t.ppf(0.975, df))
    return mp.findroot(lambda t: t_two_sided(t, df) - mp.mpf("0.05"), (guess, guess * 1.001))


def f_quantile_upper(p, d1, d2):
    guess = float(st.f.isf(float(p), d1, d2))
    return mp.findroot(lambda f: f_upper(f, d1, d2) - p, (guess, guess * 1.001))


NODES, WEIGHTS = np.polynomial.legendre.leggauss(400)


def nct_cdf(t, df, ncp):
    """P(T <= t) as the mean of Phi(t s - ncp) over s = chi / sqrt(df), in pieces around the step of Phi."""
    low, high = np.sqrt(st.chi2.ppf(1e-20, df) / df), np.sqrt(st.chi2.isf(1e-20, df) / df)
    step, width = (ncp / t, 9 / abs(t)) if t else (low, 0)
    ends = [low, *(e for e in sorted((step - width, step + width)) if low < e < high), high]
    total = 0.0
    for a, b in zip(ends, ends[1:]):
        s = 0.5 * (b - a) * NODES + 0.5 * (b + a)
        density = st.chi2.pdf(df * s * s, df) * 2 * df * s
        total += np.sum(0.5 * (b - a) * WEIGHTS * density * st.norm.cdf(t * s - ncp))
    return float(total)


def nct_interval(t, df):
    spread = 4 * math.sqrt(1 + t * t / (2 * df)) + 3
    root = lambda p: opt.brentq(lambda ncp: nct_cdf(t, df, ncp) - p, t - 4 * spread, t + 4 * spread, xtol=1e-12)
    return root(0.975), root(0.025)


def ncf_interval(f, d1, d2):
    def end(p):
        cdf = lambda ncp: float(st.ncf.cdf(f, d1, d2, ncp)) if ncp > 0 else float(st.f.cdf(f, d1, d2))
        if cdf(0.0) <= p:
            return 0.0
        high = max(1.0, d1 * f)
        while cdf(high) > p:
            high *= 2
        return opt.brentq(lambda ncp: cdf(ncp) - p, 0.0, high, xtol=1e-11)

    return end(0.95), end(0.05)


# Building blocks.
def mean(v):
    return sum(v, Q(0)) / len(v)


def as_read(q):
    """The double that a number as written becomes, exactly."""
    return Q(float(q))


def squares(v):
    m = mean(v)
    return sum(((x - m) ** 2 for x in v), Q(0))


def ranks(v):
    order = sorted(v)
    first, count = {}, Counter(v)
    for i, x in enumerate(order):
        first.setdefault(x, i)
    return [Q(2 * first[x] + count[x] + 1, 2) for x in v]


def ties(v):
    return sum(c ** 3 - c for c in Counter(v).values())


def holm(ps):
    """Holm over the pairs that have a p."""
    named = [(p, n) for n, p in ps.items() if p is not None]
    named.sort(key=lambda x: x[0])
    out, running = {n: None for n in ps}, mp.mpf(0)
    for i, (p, n) in enumerate(named):
        running = max(running, min(mp.mpf(1), (len(named) - i) * mp.mpf(p)))
        out[n] = running
    return out


class Checks(dict):
    def put(self, name, value, tol=NUMBER, scale=0):
        if value is None:
            self[name] = {"undefined": True}
            return
        entry = {"value": value if isinstance(value, int) else float(real(value))}
        if tol != EXACT:
            entry["rel_tol"], entry["abs_tol"] = tol[0], max(tol[1], float(scale))
        self[name] = entry


# Within-subject designs.
def sign_sums(doubled):
    """Number of sign changes by doubled positive rank sum."""
    counts = {0: 1}
    for r in doubled:
        after = defaultdict(int)
        for s, c in counts.items():
            after[s] += c
            after[s + r] += c
        counts = after
    return counts


def signed(d, zeros):
    """W+, W-, mean, variance, doubled ranks kept, of differences (any ordered numbers)."""
    used = [x for x in d if x != 0] if zeros == "drop" else list(d)
    r = ranks([abs(x) for x in used])
    n, z = len(used), sum(x == 0 for x in used)
    plus = sum((a for a, x in zip(r, used) if x > 0), Q(0))
    minus = sum((a for a, x in zip(r, used) if x < 0), Q(0))
    null = sum((a for a, x in zip(r, used) if x == 0), Q(0))
    tied = ties([abs(x) for x in used])
    middle, scatter = Q(n * (n + 1), 4), n * (n + 1) * (2 * n + 1)
    if zeros == "pratt":
        middle -= Q(z * (z + 1), 4)
        scatter -= z * (z + 1) * (2 * z + 1)
        tied -= z ** 3 - z
    if zeros == "split":
        plus += null / 2
        minus += null / 2
    variance = (scatter - Q(tied, 2)) / 24
    return plus, minus, middle, variance, [int(2 * a) for a, x in zip(r, used) if x != 0]


def p_signs(plus, doubled):
    if not doubled:
        return None
    counts, total = sign_sums(doubled), sum(doubled)
    gap = abs(4 * plus - total)
    hits = sum(c for s, c in counts.items() if abs(2 * s - total) >= gap)
    return mp.mpf(hits) / 2 ** len(doubled)


def p_z(plus, middle, variance, correct=0.0):
    if variance <= 0:
        return None
    gap = plus - middle
    gap -= Q(correct) * (1 if gap > 0 else -1 if gap < 0 else 0)
    return normal_two_sided(real(gap) / mp.sqrt(real(variance)))


def wilcoxon(c, name, a, b, exact_to):
    d = [x - y for x, y in zip(a, b)]
    raw = [float(x) - float(y) for x, y in zip(a, b)]
    plus, minus, middle, variance, doubled = signed(d, "drop")
    n = len(doubled)
    pre = f"wilcoxon.{name}."
    c.put(pre + "n_used", n, EXACT)
    if n == 0:
        for key in ("W_plus", "W_minus", "p_exact", "p_normal", "p_normal_cc", "p_pratt", "p_pratt_exact", "rank_biserial"):
            c.put(pre + key, None)
        return None, None, None
    exact = p_signs(plus, doubled) if n <= exact_to else None
    c.put(pre + "W_plus", plus)
    c.put(pre + "W_minus", minus)
    c.put(pre + "rank_biserial", (plus - minus) / (plus + minus))
    c.put(pre + "p_normal", p_z(plus, middle, variance), P)
    cc = p_z(plus, middle, variance, 0.5)
    c.put(pre + "p_normal_cc", cc, P)
    pratt = signed(d, "pratt")
    c.put(pre + "p_pratt", p_z(pratt[0], pratt[2], pratt[3]), P)
    if n <= exact_to:
        c.put(pre + "p_exact", exact, P)
        c.put(pre + "p_pratt_exact", p_signs(pratt[0], pratt[4]), P)
    # By name: doubles are ranked.
    rp, rm, rmid, rvar, rdoubled = signed([Q(x) for x in raw], "drop")
    clean = len(set(abs(x) for x in raw if x != 0)) == len(rdoubled) == len(raw)
    r_default = None
    if rdoubled:
        r_default = p_signs(rp, rdoubled) if clean and len(rdoubled) < 50 else p_z(rp, rmid, rvar, 0.5)
        c.put(pre + "p_r_default", r_default, P)
        sp = st.wilcoxon(np.array(raw), zero_method="zsplit", method="asymptotic")
        c.put(pre + "p_zsplit", float(sp.pvalue), P)
        if len(raw) > 13 or (clean and len(raw) <= 50):
            c.put(pre + "p_scipy_auto", float(st.wilcoxon(np.array(raw)).pvalue), P)
    return exact, cc, r_default


def friedman_exact(rows, most=120_000):
    """P(spread at least as large) by convolution over all rank-sum vectors, whole numbers only."""
    k = len(rows[0])
    states, total = {(0,) * (k - 1): 1}, 1
    sums = [sum(r[j] for r in rows) for j in range(k)]
    grand = sum(sums)
    spread = lambda s: k * sum(x * x for x in s) - sum(s) ** 2
    for row in rows:
        orders = set(itertools.permutations(row))
        after = defaultdict(int)
        if len(states) * len(orders) > most:
            return None
        for s, c in states.items():
            for o in orders:
                after[tuple(x + y for x, y in zip(s, o))] += c
        states, total = after, total * len(orders)
    seen = sum(sum(r) for r in rows)
    need = spread(sums)
    hits = sum(c for s, c in states.items() if spread(s + (seen - sum(s),)) >= need)
    assert grand == seen
    return mp.mpf(hits) / total


def within(written, names, c):
    """Moments are those of the doubles that the text reads as; ties, and whether anything varies, those of the text."""
    n, k = len(written), len(names)
    rows = [[as_read(x) for x in r] for r in written]
    if all(x - r[0] == a - written[0][0] for r in written for x, a in zip(r, written[0])):
        rows = written
    texts = [[r[j] for r in written] for j in range(k)]
    cols = [[r[j] for r in rows] for j in range(k)]
    cm, sm = [mean(x) for x in cols], [mean(r) for r in rows]
    gm = mean(cm)
    big = max(abs(x) for r in rows for x in r)
    scale = float(big) * 2e-15 + 1e-300
    c.put("n", n, EXACT)
    c.put("k", k, EXACT)
    for name, col, m in zip(names, cols, cm):
        c.put(f"desc.{name}.mean", m, NUMBER, scale)
        c.put(f"desc.{name}.sd", mp.sqrt(real(squares(col) / (n - 1))), NUMBER, scale)
    res = [[x - s - m + gm for x, m in zip(r, cm)] for r, s in zip(rows, sm)]
    ssc, sss, sse = n * squares(cm), k * squares(sm), sum((x * x for r in res for x in r), Q(0))
    d1, d2 = k - 1, (n - 1) * (k - 1)
    # What doubles of this size can give.
    floor = (scale * math.sqrt(n * k)) ** 2 + 2 * scale * math.sqrt(float(ssc + sss + sse))
    for key, value in (("ss_condition", ssc), ("ss_subject", sss), ("ss_error", sse)):
        c.put("rm_anova." + key, value, NUMBER, floor)
    c.put("rm_anova.df1", d1, EXACT)
    c.put("rm_anova.df2", d2, EXACT)
    mse, mss = sse / d2, sss / (n - 1)
    f = ssc / d1 / mse if sse else None
    c.put("rm_anova.F", f)
    c.put("rm_anova.p", None if f is None else f_upper(f, d1, d2), P)
    c.put("rm_anova.eta2_partial", ssc / (ssc + sse) if ssc + sse else None)
    c.put("rm_anova.eta2_generalized", ssc / (ssc + sse + sss) if ssc + sse + sss else None)
    c.put("rm_anova.omega2_partial", (ssc - d1 * mse) / (ssc + sse + sss + mss) if ssc + sse + sss else None)
    if f is not None and f < 5e3:
        low, high = ncf_interval(float(f), d1, d2)
        for key, ncp in (("low", low), ("high", high)):
            c.put("rm_anova.eta2_partial_ci90_" + key, ncp / (ncp + d2), INTERVAL)
            c.put("rm_anova.eta2_partial_ci90_mbess_" + key, ncp / (ncp + d1 + d2 + 1), INTERVAL)
    elif f is None:
        c.put("rm_anova.eta2_partial_ci90_low", None)
    sphericity(res, n, k, f, c)
    friedman(rows, names, c)
    # Pairs.
    t95 = t_quantile(n - 1)
    paired_p, pooled_p, w_exact, w_cc, w_r = {}, {}, {}, {}, {}
    for i, j in itertools.combinations(range(k), 2):
        name = f"{names[i]}|{names[j]}"
        pre = f"paired.{name}."
        d = [a - b for a, b in zip(cols[i], cols[j])]
        m, v = mean(d), squares(d) / (n - 1)
        if len({a - b for a, b in zip(texts[i], texts[j])}) == 1:
            v = 0
        c.put(pre + "mean_diff", m, NUMBER, scale)
        c.put(pre + "df", n - 1, EXACT)
        if v:
            se = mp.sqrt(real(v / n))
            t = real(m) / se
            paired_p[name] = t_two_sided(t, n - 1)
            c.put(pre + "t", t)
            c.put(pre + "p", paired_p[name], P)
            c.put(pre + "ci_low", real(m) - t95 * se, NUMBER, scale)
            c.put(pre + "ci_high", real(m) + t95 * se, NUMBER, scale)
            dz = real(m) / mp.sqrt(real(v))
            c.put(pre + "dz", dz)
            if n > 2:
                df = mp.mpf(n - 1)
                c.put(pre + "gz", dz * mp.gamma(df / 2) / (mp.sqrt(df / 2) * mp.gamma((df - 1) / 2)))
            else:
                c.put(pre + "gz", None)
            if abs(t) < 200 and n > 2 and (i, j) in ((0, 1), (0, k - 1)):
                low, high = nct_interval(float(t), n - 1)
                c.put(pre + "dz_ci_low", low / math.sqrt(n), INTERVAL)
                c.put(pre + "dz_ci_high", high / math.sqrt(n), INTERVAL)
        else:
            paired_p[name] = None
            for key in ("t", "p", "ci_low", "ci_high", "dz", "gz", "dz_ci_low", "dz_ci_high"):
                c.put(pre + key, None)
        both = squares(cols[i]) + squares(cols[j])
        c.put(pre + "d_av", real(m) / mp.sqrt(real(both / (2 * (n - 1)))) if both else None)
        if sse:
            t = real(cm[i] - cm[j]) / mp.sqrt(real(2 * mse / n))
            pooled_p[name] = t_two_sided(t, d2)
            c.put(f"pooled.{name}.t", t)
            c.put(f"pooled.{name}.p", pooled_p[name], P)
        else:
            pooled_p[name] = None
            c.put(f"pooled.{name}.t", None)
        w_exact[name], w_cc[name], w_r[name] = wilcoxon(c, name, texts[i], texts[j], 60)
    for group, key, ps in (
        ("paired", "p_holm", paired_p), ("pooled", "p_holm", pooled_p),
        ("wilcoxon", "p_normal_cc_holm", w_cc), ("wilcoxon", "p_r_default_holm", w_r),
    ):
        for name, p in holm(ps).items():
            if p is not None:
                c.put(f"{group}.{name}.{key}", p, P)
    if n <= 60:
        for name, p in holm(w_exact).items():
            if p is not None:
                c.put(f"wilcoxon.{name}.p_exact_holm", p, P)
    for name, sample in [*zip(names, cols), ("residuals", [x for r in res for x in r])]:
        shapiro(c, f"shapiro.{name}.", sample)


def shapiro(c, pre, sample):
    if 3 <= len(sample) <= 5000 and len(set(sample)) > 1:
        m = mean(sample)
        test = st.shapiro(np.array([float(x - m) for x in sample]))
        if test.pvalue > 1e-12:
            c.put(pre + "W", float(test.statistic), (1e-7, 1e-9))
            c.put(pre + "p", float(test.pvalue), LOOSE)


def sphericity(res, n, k, f, c):
    q = k - 1
    lam = []
    if any(x for r in res for x in r):
        contrasts = []
        for j in range(1, k):
            norm = mp.sqrt(j * (j + 1))
            contrasts.append([real(sum(r[:j], Q(0)) - j * r[j]) / norm for r in res])
        matrix = mp.matrix(q, q)
        for a in range(q):
            for b in range(q):
                matrix[a, b] = mp.fsum(x * y for x, y in zip(contrasts[a], contrasts[b]))
        lam = sorted(mp.eigsy(matrix, eigvals_only=True))
    c.put("sphericity.lower_bound", Q(1, q))
    if not lam:
        for key in ("gg", "hf", "p_gg", "p_hf", "p_lb"):
            c.put("sphericity." + key, None)
        c.put("mauchly", None)
        return
    gg = mp.fsum(lam) ** 2 / (q * mp.fsum(x * x for x in lam))
    below = n - 1 - q * gg
    raw = (n * q * gg - 2) / (q * below) if abs(below) > 1e-12 else None
    hf = min(raw, mp.mpf(1)) if raw is not None and raw > 0 else mp.mpf(1)
    c.put("sphericity.gg", gg)
    if raw is not None and abs(raw) < 1e6:
        c.put("sphericity.hf_raw", raw, (1e-9, 1e-11))
        c.put("sphericity.hf", hf)
    if f is not None:
        d1, d2 = q, (n - 1) * q
        c.put("sphericity.p_gg", f_upper(f, gg * d1, gg * d2), P)
        c.put("sphericity.p_lb", f_upper(f, mp.mpf(1), mp.mpf(n - 1)), P)
        if raw is not None and abs(raw) < 1e6:
            c.put("sphericity.p_hf", f_upper(f, hf * d1, hf * d2), P)
    if q == 1 or n < k or lam[0] <= mp.mpf(10) ** -30 * lam[-1]:
        for key in ("W", "chi2", "p"):
            c.put("mauchly." + key, None)
        return
    w = mp.fprod(lam) / (mp.fsum(lam) / q) ** q
    nu = n - 1
    rho = 1 - mp.mpf(2 * q * q + q + 2) / (6 * q * nu)
    chi2 = -nu * rho * mp.log(w)
    df = q * (q + 1) // 2 - 1
    c.put("mauchly.W", w)
    c.put("mauchly.df", df, EXACT)
    c.put("mauchly.chi2", chi2, (1e-9, 1e-11))
    if rho <= 0:
        return
    first, second = chi2_upper(chi2, df), chi2_upper(chi2, df + 4)
    c.put("mauchly.p_chi2", first, (1e-8, 1e-13))
    for key, third in (("p", k), ("p_anderson", q)):
        weight = mp.mpf((q + 2) * (q - 1) * (q - 2) * (2 * q ** 3 + 6 * q * q + 3 * third + 2)) / (288 * (nu * q * rho) ** 2)
        p = first + weight * (second - first)
        if 0 <= p <= 1:
            c.put("mauchly." + key, p, (1e-8, 1e-13))


def friedman(rows, names, c):
    n, k = len(rows), len(names)
    r = [ranks(x) for x in rows]
    sums = [sum((x[j] for x in r), Q(0)) for j in range(k)]
    middle = Q(n * (k + 1), 2)
    spread = sum((s - middle) ** 2 for s in sums)
    squared = sum(x * x for y in r for x in y)
    inner = squared - Q(n * k * (k + 1) ** 2, 4)
    d2 = (n - 1) * (k - 1)
    for i, j in itertools.combinations(range(k), 2):
        q = real(abs(sums[i] - sums[j]) / n) / mp.sqrt(mp.mpf(k * (k + 1)) / (6 * n)) * mp.sqrt(2)
        name = f"nemenyi.{names[i]}|{names[j]}."
        c.put(name + "q", q)
        if (i, j) == (0, k - 1):
            p = 1 - k * mp.quad(lambda z: mp.npdf(z) * (mp.ncdf(z) - mp.ncdf(z - q)) ** (k - 1), [-12, -4, 0, 4, 12]) if q < 7 else None
            if p is not None:
                c.put(name + "p", p, (1e-7, 1e-12))
    if inner == 0:
        for key in ("chi2", "p", "F", "F_p", "kendall_w", "p_exact"):
            c.put("friedman." + key, None)
        return
    chi2 = (k - 1) * spread / inner
    w = chi2 / (n * (k - 1))
    c.put("friedman.chi2", chi2)
    c.put("friedman.df", k - 1, EXACT)
    c.put("friedman.p", chi2_upper(chi2, k - 1), P)
    c.put("friedman.kendall_w", w)
    if w == 1:
        c.put("friedman.F", None)
        c.put("friedman.F_p", None)
    else:
        f = (n - 1) * chi2 / (n * (k - 1) - chi2)
        c.put("friedman.F", f)
        c.put("friedman.F_df1", mp.mpf(k - 1))
        c.put("friedman.F_df2", mp.mpf(d2))
        c.put("friedman.F_p", f_upper(f, k - 1, d2), P)
        m1 = k - 1 - Q(2, n)
        if m1 > 0:
            c.put("friedman.F_p_marozzi", f_upper(f, m1, (n - 1) * m1), P)
    exact = friedman_exact([[int(2 * x) for x in y] for y in r])
    if exact is not None:
        c.put("friedman.p_exact", exact, P)
    left = n * squared - sum(s * s for s in sums)
    ps = {}
    for i, j in itertools.combinations(range(k), 2):
        name = f"{names[i]}|{names[j]}"
        if left == 0:
            c.put(f"conover.{name}.t", None)
            continue
        t = real(sums[i] - sums[j]) / mp.sqrt(real(2 * left / Q(d2)))
        ps[name] = t_two_sided(t, d2)
        c.put(f"conover.{name}.t", t)
        c.put(f"conover.{name}.p", ps[name], P)
    for name, p in holm(ps).items():
        c.put(f"conover.{name}.p_holm", p, P)


# Correlations.
def r_of(x, y):
    sx, sy = squares(x), squares(y)
    if not sx or not sy:
        return None
    mx, my = mean(x), mean(y)
    xy = sum(((a - mx) * (b - my) for a, b in zip(x, y)), Q(0))
    return real(xy) / mp.sqrt(real(sx) * real(sy))


def p_r(r, df):
    return t_two_sided(r * mp.sqrt(df / (1 - r * r)), df) if abs(r) < 1 else mp.mpf(0)


Z95 = mp.mpf("1.959963984540054235524594430520551")


def fisher(c, pre, r, se):
    z = mp.atanh(r)
    c.put(pre + "low", mp.tanh(z - Z95 * se), (1e-9, 1e-11))
    c.put(pre + "high", mp.tanh(z + Z95 * se), (1e-9, 1e-11))


def correlation(x, y, c):
    n = len(x)
    c.put("n", n, EXACT)
    r = r_of(x, y)
    c.put("pearson.r", r)
    rx, ry = ranks(x), ranks(y)
    rho = r_of(rx, ry)
    c.put("spearman.rho", rho)
    if r is None:
        c.put("pearson.p", None)
        c.put("spearman.p_t", None)
        c.put("kendall.tau_b", None)
        return
    near = abs(abs(r) - 1) < mp.mpf(10) ** -40
    if n > 2 and not near:
        c.put("pearson.t", r * mp.sqrt((n - 2) / (1 - r * r)))
        c.put("pearson.df", n - 2, EXACT)
        c.put("pearson.p", p_r(r, n - 2), P)
    if n > 3 and not near:
        fisher(c, "pearson.ci_", r, 1 / mp.sqrt(n - 3))
    full = abs(abs(rho) - 1) < mp.mpf(10) ** -40
    if n > 2 and not full:
        c.put("spearman.p_t", p_r(rho, n - 2), P)
    if n > 3 and not full:
        fisher(c, "spearman.ci_", rho, 1 / mp.sqrt(n - 3))
        fisher(c, "spearman.ci_bw_", rho, mp.sqrt((1 + rho * rho / 2) / (n - 3)))
    if n <= 9:
        a, b = [int(2 * v) - n - 1 for v in rx], [int(2 * v) - n - 1 for v in ry]
        need = abs(sum(u * v for u, v in zip(a, b)))
        p = np.array(list(itertools.permutations(b)), dtype=np.int64) @ np.array(a, dtype=np.int64)
        c.put("spearman.p_exact", mp.mpf(int((np.abs(p) >= need).sum())) / len(p), P)
    if len(set(x)) < n or len(set(y)) < n:
        if n > 2 and not full:
            c.put("spearman.p_r_default", p_r(rho, n - 2), P)
    elif n > 1290 and not full:
        c.put("spearman.p_r_default", p_r(rho, n - 2), P)
    if n > 300:
        return
    tau, p = kendall(x, y)
    c.put("kendall.tau_b", tau)
    c.put("kendall.p", p, P)


def kendall(x, y):
    n = len(x)
    sign = lambda a: (a > 0) - (a < 0)
    s = sum(sign(x[i] - x[j]) * sign(y[i] - y[j]) for i in range(n) for j in range(i))
    pairs = Q(n * (n - 1), 2)
    tx, ty = list(Counter(x).values()), list(Counter(y).values())
    u, v = sum(Q(t * (t - 1), 2) for t in tx), sum(Q(t * (t - 1), 2) for t in ty)
    tau = real(s) / mp.sqrt(real((pairs - u) * (pairs - v)))
    if u == v == 0 and n < 50:
        counts = [1]
        for size in range(2, n + 1):
            after = [0] * (len(counts) + size - 1)
            for i, value in enumerate(counts):
                for j in range(size):
                    after[i + j] += value
            counts = after
        fewer = min((int(pairs) - s) // 2, (int(pairs) + s) // 2)
        return tau, min(mp.mpf(1), 2 * mp.mpf(sum(counts[: fewer + 1])) / math.factorial(n))
    three = lambda t: sum(a * (a - 1) * (a - 2) for a in t)
    five = lambda t: sum(a * (a - 1) * (2 * a + 5) for a in t)
    var = Q(n * (n - 1) * (2 * n + 5) - five(tx) - five(ty), 18) + 2 * u * v / Q(n * (n - 1))
    if n > 2:
        var += Q(three(tx) * three(ty), 9 * n * (n - 1) * (n - 2))
    return tau, normal_two_sided(real(s) / mp.sqrt(real(var)))


def rm_corr(subjects, x, y, c):
    groups = defaultdict(list)
    for s, a, b in zip(subjects, x, y):
        groups[s].append((a, b))
    dx, dy = [], []
    for pairs in groups.values():
        ma, mb = mean([a for a, _ in pairs]), mean([b for _, b in pairs])
        dx += [a - ma for a, _ in pairs]
        dy += [b - mb for _, b in pairs]
    df = len(x) - len(groups) - 1
    sx, sy, xy = (sum((a * b for a, b in zip(u, v)), Q(0)) for u, v in ((dx, dx), (dy, dy), (dx, dy)))
    if df <= 0 or not sx or not sy:
        for key in ("r", "p"):
            c.put("rm_corr." + key, None)
        return
    r = real(xy) / mp.sqrt(real(sx) * real(sy))
    c.put("rm_corr.r", r)
    c.put("rm_corr.df", df, EXACT)
    if abs(r) < 1 - mp.mpf(10) ** -30:
        c.put("rm_corr.p", p_r(r, df), P)
        if df > 1:
            fisher(c, "rm_corr.ci_", r, 1 / mp.sqrt(df - 1))


def items(rows, c):
    k = len(rows[0])
    full = [r for r in rows if None not in r]
    n = len(full)
    c.put("n", n, EXACT)
    c.put("k", k, EXACT)
    cols = [[r[j] for r in full] for j in range(k)]

    def alpha(which):
        total = squares([sum((r[j] for j in which), Q(0)) for r in full])
        return None if len(which) < 2 or not total else Q(len(which), len(which) - 1) * (1 - sum(squares(cols[j]) for j in which) / total)

    raw = alpha(range(k))
    c.put("alpha.raw", raw)
    rs = [r_of(cols[i], cols[j]) for i in range(k) for j in range(i)]
    if None in rs:
        c.put("alpha.mean_r", None)
        c.put("alpha.standardized", None)
    else:
        m = mp.fsum(rs) / len(rs)
        c.put("alpha.mean_r", m)
        if abs(1 + (k - 1) * m) > 1e-6:
            c.put("alpha.standardized", k * m / (1 + (k - 1) * m))
    if raw is not None:
        d1, d2 = n - 1, (n - 1) * (k - 1)
        c.put("alpha.ci_low", 1 - (1 - real(raw)) * f_quantile_upper(mp.mpf("0.025"), d1, d2))
        c.put("alpha.ci_high", 1 - (1 - real(raw)) * f_quantile_upper(mp.mpf("0.975"), d1, d2))
    for j in range(k):
        c.put(f"drop.{j}.alpha", alpha([i for i in range(k) if i != j]))
        rest = [sum((r[i] for i in range(k) if i != j), Q(0)) for r in full]
        c.put(f"item.{j}.r_drop", r_of(cols[j], rest))


def sample(v, c):
    n = len(v)
    c.put("n", n, EXACT)
    scale = float(max(abs(x) for x in v)) * 2e-15
    m = mean(v)
    c.put("desc.mean", m, NUMBER, scale)
    if n > 1:
        c.put("desc.sd", mp.sqrt(real(squares(v) / (n - 1))), NUMBER, scale)
    order = sorted(v)
    for key, p in (("median", Q(1, 2)), ("q1", Q(1, 4)), ("q3", Q(3, 4))):
        h = p * (n - 1)
        i = int(h)
        c.put("desc." + key, order[i] + (h - i) * (order[min(i + 1, n - 1)] - order[i]), NUMBER, scale)
    if len(set(v)) > 1:
        m2, m3, m4 = (real(sum(((x - m) ** e for x in v), Q(0)) / n) for e in (2, 3, 4))
        c.put("desc.skew_g1", m3 / m2 ** mp.mpf("1.5"), (1e-9, 1e-11))
        c.put("desc.kurtosis_g2", m4 / m2 ** 2 - 3, (1e-9, 1e-11))
    else:
        c.put("desc.skew_g1", None)
        c.put("shapiro.W", None)
    shapiro(c, "shapiro.", v)


def between(groups, values, c):
    parts = defaultdict(list)
    for g, v in zip(groups, values):
        parts[g].append(v)
    parts = list(parts.values())
    k, n = len(parts), len(values)

    def median(v):
        s = sorted(v)
        return (s[(len(s) - 1) // 2] + s[len(s) // 2]) / 2

    for name, centre in (("levene_mean", mean), ("levene_median", median)):
        z = [[abs(x - centre(p)) for x in p] for p in parts]
        grand = mean([x for p in z for x in p])
        inner = sum((squares(p) for p in z), Q(0))
        outer = sum((len(p) * (mean(p) - grand) ** 2 for p in z), Q(0))
        c.put(name + ".df1", k - 1, EXACT)
        c.put(name + ".df2", n - k, EXACT)
        if inner:
            f = (outer / (k - 1)) / (inner / (n - k))
            c.put(name + ".F", f, (1e-9, 1e-11))
            c.put(name + ".p", f_upper(f, k - 1, n - k), P)
        else:
            c.put(name + ".F", None)
    if all(len(p) > 1 and squares(p) for p in parts):
        total = n - k
        pooled = sum((squares(p) for p in parts), Q(0)) / total
        logs = mp.fsum((len(p) - 1) * mp.log(real(squares(p) / (len(p) - 1))) for p in parts)
        correct = 1 + (sum(Q(1, len(p) - 1) for p in parts) - Q(1, total)) / (3 * (k - 1))
        k2 = (total * mp.log(real(pooled)) - logs) / real(correct)
        c.put("bartlett.K2", k2, (1e-9, 1e-11))
        c.put("bartlett.p", chi2_upper(k2, k - 1), P)
    else:
        c.put("bartlett.K2", None)


def p_adjust(p, c):
    m = len(p)
    order = sorted(range(m), key=lambda i: p[i])
    running, h = mp.mpf(0), {}
    for place, i in enumerate(order):
        running = max(running, min(mp.mpf(1), (m - place) * real(p[i])))
        h[i] = running
        c.put(f"bonferroni.{i}", min(mp.mpf(1), m * real(p[i])), P)
    up, down = mp.mpf(1), mp.mpf(1)
    for place, i in reversed(list(enumerate(order))):
        up, down = min(up, (m - place) * real(p[i])), min(down, mp.mpf(m) / (place + 1) * real(p[i]))
        c.put(f"hochberg.{i}", up, P)
        c.put(f"bh.{i}", down, P)
    for i in range(m):
        c.put(f"holm.{i}", h[i], P)


def power_of(test, n, effect, alpha, k, corr, eps):
    if test == "paired_t":
        df = n - 1
        crit = float(st.t.isf(alpha / 2, df))
        return 1 - nct_cdf(crit, df, effect * math.sqrt(n)) + nct_cdf(-crit, df, effect * math.sqrt(n))
    if test == "pearson":
        crit = float(st.t.isf(alpha / 2, n - 2))
        limit = math.atanh(crit / math.sqrt(crit * crit + n - 2))
        z = math.atanh(effect) + effect / (2 * (n - 1))
        return float(st.norm.sf((limit - z) * math.sqrt(n - 3)) + st.norm.cdf((-limit - z) * math.sqrt(n - 3)))
    ncp = effect / (1 - effect) * n * k * eps / (1 - corr)
    d1 = (k - 1) * eps
    d2 = d1 * (n - 1)
    return float(st.ncf.sf(st.f.isf(alpha, d1, d2), d1, d2, ncp))
