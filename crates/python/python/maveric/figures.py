"""Figures as SVG and PNG that a notebook shows, from exactly the plain numbers that each draws.

Each figure is a function of this module; its arguments are the fields of the figure's input in the Rust crate ``maveric-report``
(its documentation says what each is), as numbers, text, lists and dicts.

>>> import maveric
>>> maveric.figures.scatter(x="Age", y="Speed", points=[[21, 31], [40, 29], [63, 26]], test="r = -1", people=[])
<maveric.Figure scatter: Speed and Age>
"""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

from . import _native


def _plain(value: Any) -> Any:
    """What JSON does not know: arrays of numpy and the like."""
    if hasattr(value, "tolist"):
        return value.tolist()
    raise TypeError(f"{type(value).__name__} is neither number, text, list nor dict")


def draw(name: str, synthetic: int | None = None, **fields: Any) -> _native.Figure:
    """Draw a figure.

    Parameters
    ----------
    name : str
        One of `names`.
    synthetic : int, optional
        The seed of made-up participants; the figure then says that they do not exist.
    **fields
        The figure's own fields.

    Returns
    -------
    Figure
        With ``svg``, ``png()``, ``title``, ``caption`` and ``alt``; a notebook shows it.

    Raises
    ------
    Error
        Naming the field that is missing or of another kind, or the number that cannot be drawn.
    """
    return _native.draw(name, json.dumps(fields, default=_plain, allow_nan=False), synthetic)


names: list[str] = _native.figure_names()


def __getattr__(name: str) -> Callable[..., _native.Figure]:
    if name not in names:
        raise AttributeError(f"there is no figure `{name}`; there are {', '.join(names)}")

    def figure(synthetic: int | None = None, **fields: Any) -> _native.Figure:
        return draw(name, synthetic, **fields)

    figure.__name__ = name
    return figure


def __dir__() -> list[str]:
    return ["draw", "names", *names]
