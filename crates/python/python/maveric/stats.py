"""Statistics for designs of repeated measures and of groups: every call of ``maveric stats``, with its names and its numbers.

A table is a data frame (polars, pandas 2.2 or newer, pyarrow) or a dict of lists; a missing cell is null. Each function gives a
`Result`: names as attributes, the command's report as text. What a test refuses raises `Error` with the command's words.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from . import _native
from ._arrow import columns_of
from ._result import Result

Where = Mapping[str, Any] | None
Path = str | os.PathLike[str] | None


def _flag(name: str, value: Any) -> list[str]:
    if value is None or value is False:
        return []
    # `with` is a word of the language: its parameter ends in an underscore.
    flag = "--" + name.rstrip("_")
    if value is True:
        return [flag]
    if isinstance(value, Iterable) and not isinstance(value, (str, os.PathLike)):
        value = ",".join(str(each) for each in value)
    return [f"{flag}={value}"]


def _call(call: str, data: Any, where: Where, /, **flags: Any) -> Result:
    words = [call, "table"]
    for name, value in flags.items():
        words += _flag(name, value)
    for column, value in (where or {}).items():
        # Flags are words in a table.
        words.append(f"--where={column}={str(value).lower() if isinstance(value, bool) else value}")
    found, report, warnings = _native.stats(words, columns_of(data))
    return Result(json.loads(found), report, warnings)


def within(
    data: Any,
    *,
    subject: str | None = None,
    within: str | None = None,
    value: str | Sequence[str] | None = None,
    wide: Sequence[str] | None = None,
    where: Where = None,
    figure: Path = None,
) -> Result:
    """The whole analysis of a within-subject design.

    Parameters
    ----------
    data : data frame or dict of lists
        A row a cell; or a column a condition, by `wide`.
    subject : str, optional
        Column that says whose row it is.
    within : str, optional
        Column that says in which condition.
    value : str or list of str, optional
        Column with the value; several are analysed one by one.
    wide : list of str, optional
        Columns that are conditions, in the place of `within` and `value`.
    where : dict, optional
        Keep the rows that have these values in these columns.
    figure : path, optional
        Draw the result into this file (.svg, .png or .pdf).

    Examples
    --------
    >>> import maveric
    >>> cells = {"id": ["a", "a", "b", "b", "c", "c"], "condition": list("xyxyxy"), "score": [1, 3, 2, 5, 2, 4]}
    >>> maveric.stats.within(cells, subject="id", within="condition", value="score").n
    3
    """
    return _call(
        "within",
        data,
        where,
        subject=subject,
        within=within,
        value=value,
        wide=wide,
        figure=figure,
    )


def rm_anova(
    data: Any,
    *,
    subject: str | None = None,
    within: str | None = None,
    value: str | Sequence[str] | None = None,
    wide: Sequence[str] | None = None,
    where: Where = None,
    figure: Path = None,
) -> Result:
    """Repeated-measures ANOVA with Mauchly's test and corrected degrees of freedom.

    Parameters
    ----------
    data : data frame or dict of lists
        A row a cell; or a column a condition, by `wide`.
    subject : str, optional
        Column that says whose row it is.
    within : str, optional
        Column that says in which condition.
    value : str or list of str, optional
        Column with the value; several are analysed one by one.
    wide : list of str, optional
        Columns that are conditions, in the place of `within` and `value`.
    where : dict, optional
        Keep the rows that have these values in these columns.
    figure : path, optional
        Draw the result into this file (.svg, .png or .pdf).
    """
    return _call(
        "rm-anova",
        data,
        where,
        subject=subject,
        within=within,
        value=value,
        wide=wide,
        figure=figure,
    )


def friedman(
    data: Any,
    *,
    subject: str | None = None,
    within: str | None = None,
    value: str | Sequence[str] | None = None,
    wide: Sequence[str] | None = None,
    where: Where = None,
    figure: Path = None,
) -> Result:
    """Friedman's test: chi-squared, Iman-Davenport F, exact.

    Parameters
    ----------
    data : data frame or dict of lists
        A row a cell; or a column a condition, by `wide`.
    subject : str, optional
        Column that says whose row it is.
    within : str, optional
        Column that says in which condition.
    value : str or list of str, optional
        Column with the value; several are analysed one by one.
    wide : list of str, optional
        Columns that are conditions, in the place of `within` and `value`.
    where : dict, optional
        Keep the rows that have these values in these columns.
    figure : path, optional
        Draw the result into this file (.svg, .png or .pdf).
    """
    return _call(
        "friedman",
        data,
        where,
        subject=subject,
        within=within,
        value=value,
        wide=wide,
        figure=figure,
    )


def posthoc(
    data: Any,
    *,
    subject: str | None = None,
    within: str | None = None,
    value: str | Sequence[str] | None = None,
    wide: Sequence[str] | None = None,
    test: str = "t",
    adjust: str = "holm",
    where: Where = None,
    figure: Path = None,
) -> Result:
    """Every pair of conditions, adjusted.

    Parameters
    ----------
    data : data frame or dict of lists
        A row a cell; or a column a condition, by `wide`.
    subject : str, optional
        Column that says whose row it is.
    within : str, optional
        Column that says in which condition.
    value : str or list of str, optional
        Column with the value; several are analysed one by one.
    wide : list of str, optional
        Columns that are conditions, in the place of `within` and `value`.
    test : {"t", "pooled-t", "wilcoxon", "conover", "nemenyi"}
        Test of a pair.
    adjust : {"holm", "bonferroni", "hochberg", "bh", "none"}
        Adjustment for the number of pairs.
    where : dict, optional
        Keep the rows that have these values in these columns.
    figure : path, optional
        Draw the result into this file (.svg, .png or .pdf).
    """
    return _call(
        "posthoc",
        data,
        where,
        subject=subject,
        within=within,
        value=value,
        wide=wide,
        test=test,
        adjust=adjust,
        figure=figure,
    )


def mcnemar(
    data: Any,
    *,
    subject: str | None = None,
    within: str | None = None,
    value: str | Sequence[str] | None = None,
    wide: Sequence[str] | None = None,
    where: Where = None,
    figure: Path = None,
) -> Result:
    """Two conditions answered with yes or no by the same people: McNemar, exact and mid-p.

    Parameters
    ----------
    data : data frame or dict of lists
        A row a cell, with yes and no, true and false, or 1 and 0; or a column a condition, by `wide`.
    subject : str, optional
        Column that says whose row it is.
    within : str, optional
        Column that says in which condition.
    value : str or list of str, optional
        Column with the value; several are analysed one by one.
    wide : list of str, optional
        Columns that are conditions, in the place of `within` and `value`.
    where : dict, optional
        Keep the rows that have these values in these columns.
    figure : path, optional
        Draw the result into this file (.svg, .png or .pdf).
    """
    return _call(
        "mcnemar",
        data,
        where,
        subject=subject,
        within=within,
        value=value,
        wide=wide,
        figure=figure,
    )


def cochran_q(
    data: Any,
    *,
    subject: str | None = None,
    within: str | None = None,
    value: str | Sequence[str] | None = None,
    wide: Sequence[str] | None = None,
    where: Where = None,
    figure: Path = None,
) -> Result:
    """Conditions answered with yes or no by the same people: Cochran's Q, then McNemar of each pair.

    Parameters
    ----------
    data : data frame or dict of lists
        A row a cell, with yes and no, true and false, or 1 and 0; or a column a condition, by `wide`.
    subject : str, optional
        Column that says whose row it is.
    within : str, optional
        Column that says in which condition.
    value : str or list of str, optional
        Column with the value; several are analysed one by one.
    wide : list of str, optional
        Columns that are conditions, in the place of `within` and `value`.
    where : dict, optional
        Keep the rows that have these values in these columns.
    figure : path, optional
        Draw the result into this file (.svg, .png or .pdf).
    """
    return _call(
        "cochran-q",
        data,
        where,
        subject=subject,
        within=within,
        value=value,
        wide=wide,
        figure=figure,
    )


def compare(
    data: Any,
    *,
    subject: str | None = None,
    within: str | Sequence[str] | None = None,
    between: str | Sequence[str] | None = None,
    value: str | Sequence[str] | None = None,
    wide: Sequence[str] | None = None,
    covariate: str | Sequence[str] | None = None,
    with_: str | Sequence[str] | None = None,
    ordinal: bool = False,
    missing: str = "listwise",
    where: Where = None,
    figure: Path = None,
) -> Result:
    """The test that the design calls for: checks the assumptions, chooses, compares the pairs, says why.

    Parameters
    ----------
    data : data frame or dict of lists
        A row a cell; or a column a condition, by `wide`; without `within` a row a person.
    subject : str, optional
        Column that says whose row it is.
    within : str or list of str, optional
        Columns of the factors within subjects, one or two.
    between : str or list of str, optional
        Columns of the factors between subjects, one or two.
    value : str or list of str, optional
        Column with the value; several are analysed one by one.
    wide : list of str, optional
        Columns that are conditions, in the place of `within` and `value`.
    covariate : str or list of str, optional
        Columns of numbers whose influence is taken out.
    with_ : str or list of str, optional
        Products that are tested: `age:style`, whether the effect of `style` within subjects changes with `age`.
    ordinal : bool
        The values are ordered answers: of one factor only their order counts, of several ranks are of means and differences of their numbers.
    missing : {"listwise", "mixed"}
        What becomes of a person without every cell.
    where : dict, optional
        Keep the rows that have these values in these columns.
    figure : path, optional
        Draw the result into this file (.svg, .png or .pdf).
    """
    return _call(
        "compare",
        data,
        where,
        subject=subject,
        within=within,
        between=between,
        value=value,
        wide=wide,
        covariate=covariate,
        with_=with_,
        ordinal=ordinal,
        missing=missing,
        figure=figure,
    )


def factorial(
    data: Any,
    *,
    subject: str | None = None,
    within: str | Sequence[str] | None = None,
    between: str | Sequence[str] | None = None,
    value: str | Sequence[str] | None = None,
    wide: Sequence[str] | None = None,
    method: str = "anova",
    where: Where = None,
    figure: Path = None,
) -> Result:
    """Up to two factors within subjects and two between: F, means, contrasts, simple effects; or aligned ranks.

    Parameters
    ----------
    data : data frame or dict of lists
        A row a cell; without `within` a row a person.
    subject : str, optional
        Column that says whose row it is.
    within : str or list of str, optional
        Columns of the factors within subjects, one or two.
    between : str or list of str, optional
        Columns of the factors between subjects, one or two.
    value : str or list of str, optional
        Column with the value; several are analysed one by one.
    wide : list of str, optional
        Columns that are conditions, in the place of `within` and `value`.
    method : {"anova", "art"}
        Analysis of variance; or aligned ranks, for comparing with other programs: on skewed values they find too much, as a warning says.
    where : dict, optional
        Keep the rows that have these values in these columns.
    figure : path, optional
        Draw the result into this file (.svg, .png or .pdf).
    """
    return _call(
        "factorial",
        data,
        where,
        subject=subject,
        within=within,
        between=between,
        value=value,
        wide=wide,
        method=method,
        figure=figure,
    )


def mixed(
    data: Any,
    *,
    subject: str,
    fixed: str | None = None,
    within: str | Sequence[str] | None = None,
    between: str | Sequence[str] | None = None,
    covariate: str | Sequence[str] | None = None,
    value: str | Sequence[str],
    wide: Sequence[str] | None = None,
    where: Where = None,
    figure: Path = None,
) -> Result:
    """A linear model with a random intercept, Satterthwaite's degrees of freedom.

    Parameters
    ----------
    data : data frame or dict of lists
        Any number of rows a person.
    subject : str
        Column that says whose row it is.
    fixed : str, optional
        Fixed effects: columns joined by +, : (their product) or * (both and their product). A predictor whose values are all
        numbers is a covariate, any other a factor.
    within, between : str or list of str, optional
        In the place of `fixed`: columns of the factors within and between subjects, which go in with all their products.
    covariate : str or list of str, optional
        In the place of `fixed`: columns of numbers whose influence is taken out.
    value : str or list of str
        Column with the value.
    wide : list of str, optional
        Columns that are conditions: they become the columns ``condition`` and ``value``, and without `subject` each row a subject, ``row``.
    where : dict, optional
        Keep the rows that have these values in these columns.
    figure : path, optional
        Draw the result into this file (.svg, .png or .pdf).
    """
    return _call(
        "mixed",
        data,
        where,
        subject=subject,
        fixed=fixed,
        within=within,
        between=between,
        covariate=covariate,
        value=value,
        wide=wide,
        figure=figure,
    )


def ordinal(
    data: Any,
    *,
    subject: str | None = None,
    within: str | None = None,
    value: str | Sequence[str] | None = None,
    wide: Sequence[str] | None = None,
    where: Where = None,
    figure: Path = None,
) -> Result:
    """Ordered answers: a cumulative logit model with a random intercept.

    Parameters
    ----------
    data : data frame or dict of lists
        Any number of rows a person and condition, the answer as a whole number.
    subject : str, optional
        Column that says whose row it is.
    within : str, optional
        Column that says in which condition.
    value : str or list of str, optional
        Column with the value; several are analysed one by one.
    wide : list of str, optional
        Columns that are conditions, in the place of `within` and `value`.
    where : dict, optional
        Keep the rows that have these values in these columns.
    figure : path, optional
        Draw the result into this file (.svg, .png or .pdf).
    """
    return _call(
        "ordinal",
        data,
        where,
        subject=subject,
        within=within,
        value=value,
        wide=wide,
        figure=figure,
    )


def groups(
    data: Any,
    *,
    group: str,
    value: str | Sequence[str],
    wide: Sequence[str] | None = None,
    where: Where = None,
    figure: Path = None,
) -> Result:
    """Independent groups: each pair, and all of them at once.

    Parameters
    ----------
    data : data frame or dict of lists
        A row a person.
    group : str
        Column that groups the rows.
    value : str or list of str
        Column with the value; several are analysed one by one.
    wide : list of str, optional
        Columns that are conditions: they become the columns ``condition`` and ``value``, and without `subject` each row a subject, ``row``.
    where : dict, optional
        Keep the rows that have these values in these columns.
    figure : path, optional
        Draw the result into this file (.svg, .png or .pdf).
    """
    return _call(
        "groups",
        data,
        where,
        group=group,
        value=value,
        wide=wide,
        figure=figure,
    )


def equivalence(
    data: Any,
    *,
    value: str,
    bounds: tuple[float, float],
    subject: str | None = None,
    within: str | None = None,
    mu: float | None = None,
    standardized: bool = False,
    wide: Sequence[str] | None = None,
    where: Where = None,
    figure: Path = None,
) -> Result:
    """Is the difference of conditions, or of a mean from a value, smaller than bounds? Two one-sided tests.

    Parameters
    ----------
    data : data frame or dict of lists
        A row a cell; for one sample a column with the value.
    value : str
        Column with the value.
    bounds : (float, float)
        Differences that count as none.
    subject : str, optional
        Column that says whose row it is.
    within : str, optional
        Column that says in which condition.
    mu : float, optional
        What the mean of one sample is compared with.
    standardized : bool
        The bounds are in standard deviations of the differences.
    wide : list of str, optional
        Columns that are conditions: they become the columns ``condition`` and ``value``, and without `subject` each row a subject, ``row``.
    where : dict, optional
        Keep the rows that have these values in these columns.
    figure : path, optional
        Draw the result into this file (.svg, .png or .pdf).
    """
    return _call(
        "equivalence",
        data,
        where,
        value=value,
        bounds=bounds,
        subject=subject,
        within=within,
        mu=mu,
        standardized=standardized,
        wide=wide,
        figure=figure,
    )


def bayes(
    data: Any,
    *,
    subject: str | None = None,
    within: str | None = None,
    value: str | None = None,
    mu: float | None = None,
    group: str | None = None,
    x: str | None = None,
    y: str | None = None,
    wide: Sequence[str] | None = None,
    where: Where = None,
    figure: Path = None,
) -> Result:
    """Bayes factors of t tests and correlations.

    Parameters
    ----------
    data : data frame or dict of lists
        A row a cell with subject, condition and value; or a row a person with the value, with group and value, or with two values.
    subject : str, optional
        Column that says whose row it is.
    within : str, optional
        Column that says in which condition.
    value : str, optional
        Column with the value.
    mu : float, optional
        What the mean of one sample is compared with.
    group : str, optional
        Column that groups the rows.
    x : str, optional
        First column of a correlation.
    y : str, optional
        Second column of a correlation.
    wide : list of str, optional
        Columns that are conditions: they become the columns ``condition`` and ``value``, and without `subject` each row a subject, ``row``.
    where : dict, optional
        Keep the rows that have these values in these columns.
    figure : path, optional
        Draw the result into this file (.svg, .png or .pdf).
    """
    return _call(
        "bayes",
        data,
        where,
        subject=subject,
        within=within,
        value=value,
        mu=mu,
        group=group,
        x=x,
        y=y,
        wide=wide,
        figure=figure,
    )


def correlate(
    data: Any,
    *,
    x: str,
    y: str,
    method: str = "auto",
    subject: str | None = None,
    where: Where = None,
    figure: Path = None,
) -> Result:
    """Correlation of two columns.

    Parameters
    ----------
    data : data frame or dict of lists
        A row a person (or a measurement).
    x : str
        First column.
    y : str
        Second column.
    method : {"auto", "pearson", "spearman", "kendall", "all"}
        Which coefficient.
    subject : str, optional
        Column that says whose row it is.
    where : dict, optional
        Keep the rows that have these values in these columns.
    figure : path, optional
        Draw the result into this file (.svg, .png or .pdf).

    Examples
    --------
    >>> import maveric
    >>> round(maveric.stats.correlate({"x": [1, 2, 3, 4], "y": [1, 3, 2, 4]}, x="x", y="y", method="pearson").pearson.r, 3)
    0.8
    """
    return _call(
        "correlate",
        data,
        where,
        x=x,
        y=y,
        method=method,
        subject=subject,
        figure=figure,
    )


def rmcorr(data: Any, *, subject: str, x: str, y: str, where: Where = None, figure: Path = None) -> Result:
    """Repeated-measures correlation: several rows a subject.

    Parameters
    ----------
    data : data frame or dict of lists
        Several rows a person.
    subject : str
        Column that says whose row it is.
    x : str
        First column.
    y : str
        Second column.
    where : dict, optional
        Keep the rows that have these values in these columns.
    figure : path, optional
        Draw the result into this file (.svg, .png or .pdf).
    """
    return _call(
        "rmcorr",
        data,
        where,
        subject=subject,
        x=x,
        y=y,
        figure=figure,
    )


def normality(
    data: Any,
    *,
    value: str,
    group: str | None = None,
    wide: Sequence[str] | None = None,
    where: Where = None,
    figure: Path = None,
) -> Result:
    """Shapiro-Wilk and the moments of a column.

    Parameters
    ----------
    data : data frame or dict of lists
        A row a value.
    value : str
        Column with the value.
    group : str, optional
        Column that groups the rows.
    wide : list of str, optional
        Columns that are conditions: they become the columns ``condition`` and ``value``, and without `subject` each row a subject, ``row``.
    where : dict, optional
        Keep the rows that have these values in these columns.
    figure : path, optional
        Draw the result into this file (.svg, .png or .pdf).
    """
    return _call(
        "normality",
        data,
        where,
        value=value,
        group=group,
        wide=wide,
        figure=figure,
    )


def levene(
    data: Any,
    *,
    group: str,
    value: str,
    wide: Sequence[str] | None = None,
    where: Where = None,
    figure: Path = None,
) -> Result:
    """Equal variances: Levene, Brown-Forsythe, Bartlett.

    Parameters
    ----------
    data : data frame or dict of lists
        A row a person.
    group : str
        Column that groups the rows.
    value : str
        Column with the value.
    wide : list of str, optional
        Columns that are conditions: they become the columns ``condition`` and ``value``, and without `subject` each row a subject, ``row``.
    where : dict, optional
        Keep the rows that have these values in these columns.
    figure : path, optional
        Draw the result into this file (.svg, .png or .pdf).
    """
    return _call(
        "levene",
        data,
        where,
        group=group,
        value=value,
        wide=wide,
        figure=figure,
    )


def alpha(
    data: Any,
    *,
    items: Sequence[str],
    subject: str | None = None,
    where: Where = None,
    figure: Path = None,
) -> Result:
    """Cronbach's alpha and omega of a scale.

    Parameters
    ----------
    data : data frame or dict of lists
        A row an answer sheet, a column an item, reversed items turned already.
    items : list of str
        Columns of the items.
    subject : str, optional
        Column that says whose row it is.
    where : dict, optional
        Keep the rows that have these values in these columns.
    figure : path, optional
        Draw the result into this file (.svg, .png or .pdf).
    """
    return _call(
        "alpha",
        data,
        where,
        items=items,
        subject=subject,
        figure=figure,
    )


def adjust(data: Any, *, p: str = "p", where: Where = None, figure: Path = None) -> Result:
    """P values adjusted for their number.

    Parameters
    ----------
    data : data frame or dict of lists
        A row a test.
    p : str
        Column of p values.
    where : dict, optional
        Keep the rows that have these values in these columns.
    figure : path, optional
        Draw the result into this file (.svg, .png or .pdf).

    Examples
    --------
    >>> import maveric
    >>> maveric.stats.adjust({"p": [0.01, 0.04, 0.03]}).holm
    [0.03, 0.06, 0.06]
    """
    return _call(
        "adjust",
        data,
        where,
        p=p,
        figure=figure,
    )


def bootstrap(
    data: Any,
    *,
    statistic: str,
    value: str | None = None,
    x: str | None = None,
    y: str | None = None,
    subject: str | None = None,
    within: str | None = None,
    resamples: int = 10_000,
    seed: int = 1,
    wide: Sequence[str] | None = None,
    where: Where = None,
    figure: Path = None,
) -> Result:
    """Percentile and BCa intervals by resampling.

    Parameters
    ----------
    data : data frame or dict of lists
        A column of values; two of a correlation; or a row a cell.
    statistic : {"mean", "median", "pearson", "spearman", "eta2_partial", "eta2_generalized", "omega2_partial", "kendall_w"}
        What to estimate.
    value : str, optional
        Column with the value.
    x : str, optional
        First column of a correlation.
    y : str, optional
        Second column of a correlation.
    subject : str, optional
        Column that says whose row it is.
    within : str, optional
        Column that says in which condition.
    resamples : int
        Resamples.
    seed : int
        Root of the random choice.
    wide : list of str, optional
        Columns that are conditions: they become the columns ``condition`` and ``value``, and without `subject` each row a subject, ``row``.
    where : dict, optional
        Keep the rows that have these values in these columns.
    figure : path, optional
        Draw the result into this file (.svg, .png or .pdf).
    """
    return _call(
        "bootstrap",
        data,
        where,
        statistic=statistic,
        value=value,
        x=x,
        y=y,
        subject=subject,
        within=within,
        resamples=resamples,
        seed=seed,
        wide=wide,
        figure=figure,
    )


def power(data: Any, *, where: Where = None, figure: Path = None) -> Result:
    """Power of a design, and the sample for 80 %.

    Parameters
    ----------
    data : data frame or dict of lists
        A question a row: ``test`` (paired_t, pearson or rm_anova), ``n``, ``effect``, ``alpha``; of rm_anova also ``k``, ``corr`` and ``epsilon``.
    where : dict, optional
        Keep the rows that have these values in these columns.
    figure : path, optional
        Draw the result into this file (.svg, .png or .pdf).
    """
    return _call(
        "power",
        data,
        where,
        figure=figure,
    )


def recheck(data: Any, *, where: Where = None, figure: Path = None) -> Result:
    """Does each printed p follow from its printed coefficient and degrees of freedom?

    Parameters
    ----------
    data : data frame or dict of lists
        A printed correlation a row, as text: ``coefficient``, ``df``, ``p``.
    where : dict, optional
        Keep the rows that have these values in these columns.
    figure : path, optional
        Draw the result into this file (.svg, .png or .pdf).
    """
    return _call(
        "recheck",
        data,
        where,
        figure=figure,
    )
