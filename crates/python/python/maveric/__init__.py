"""Driving styles learned, driven and studied.

``stats`` has the tests of repeated measures and groups, ``read_log`` reads driving logs, ``Model`` learns how people drive,
``simulate`` and ``drive_in`` let a style or any planner drive, ``figures`` draws, ``run`` brings a study up to date. The command
``maveric`` comes with the package.
"""

from . import figures, highway_env, stats, sumo
from ._arrow import Table
from ._native import Figure, MavericError as Error, Planner, Style, version as _version
from ._result import Result
from .driving import Drive, Driven, Model, drive_in, read_log, simulate
from .study import command, run, score

__version__ = _version()
__all__ = [
    "Drive",
    "Driven",
    "Error",
    "Figure",
    "Model",
    "Planner",
    "Result",
    "Style",
    "Table",
    "command",
    "drive_in",
    "figures",
    "highway_env",
    "read_log",
    "run",
    "score",
    "simulate",
    "stats",
    "sumo",
]
