"""Figures as SVG and PNG that a notebook shows, from exactly the plain numbers that each draws.

Each figure is a function of this module; its arguments are the fields of the figure's input in the Rust crate ``maveric-report``
(its documentation says what each is), as numbers, text, lists and dicts.

>>> import maveric
>>> maveric.figures.scatter(x="Age", y="Speed", points=[[21, 31], [40, 29], [63, 26]], test="r = -1", people=[])
<maveric.Figure scatter: Speed and Age>
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from . import _native
from ._native import MavericError as Error


def _plain(value: Any) -> Any:
    """What JSON does not know: arrays of numpy and the like."""
    if hasattr(value, "tolist"):
        return value.tolist()
    raise Error(f"a figure cannot draw {type(value).__name__}, expected numbers, text, lists and dicts")


def _json(value: Any) -> str:
    try:
        return json.dumps(value, default=_plain, allow_nan=False)
    except ValueError as error:
        raise Error("a figure cannot draw NaN or infinity; what is not there is None") from error


Conditions = Sequence[Mapping[str, Any]]


def draw(
    name: str, synthetic: int | None = None, conditions: Conditions | None = None, **fields: Any
) -> _native.Figure:
    """Draw a figure.

    Parameters
    ----------
    name : str
        One of `names`.
    synthetic : int, optional
        The seed of made-up participants; the figure then says that they do not exist.
    conditions : list of dict, optional
        How the conditions that the input names look, in order: ``id``, ``label`` and ``color`` (``"#1f77b4"``) as in a ``study.toml``.
        One that is not listed is grey and called by its id.
    **fields
        The figure's own fields.

    Returns
    -------
    Figure
        With ``svg``, ``png()``, ``title``, ``caption`` and ``alt``; a notebook shows it.

    Raises
    ------
    Error
        Naming the field that is missing, unknown or of another kind, or the number that cannot be drawn.
    """
    looks = None if conditions is None else _json(list(conditions))
    return _native.draw(name, _json(fields), synthetic, looks)


names: list[str] = _native.figure_names()


def __getattr__(name: str) -> Callable[..., _native.Figure]:
    if name not in names:
        raise AttributeError(f"there is no figure `{name}`; there are {', '.join(names)}")

    def figure(synthetic: int | None = None, conditions: Conditions | None = None, **fields: Any) -> _native.Figure:
        return draw(name, synthetic, conditions, **fields)

    figure.__name__ = name
    return figure


def __dir__() -> list[str]:
    return ["draw", "names", *names]
