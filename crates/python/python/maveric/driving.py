"""Drives, models of drivers, and cars under way."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from . import _native
from ._arrow import Table
from ._native import MavericError as Error
from ._native import Style

Vehicle = tuple[int, float, float, float, float]
"""Id, x along the road and y to the left (m, of the centre; lane 0 is the right one, its centre at y = 0), speed (m/s), length (m)."""
Ego = tuple[float, float, float, float]
"""x, y, speed and length, as in `Vehicle`."""
World = Callable[[Ego], Sequence[Vehicle] | None]
"""Moves everybody else on to where they are when ego is where it says; None ends the drive."""
AnyPlanner = Callable[[dict[str, Any]], tuple[float, float, str]]
"""Sees a scene; asks for a speed (m/s), a gap (m, bumper to bumper) and ``stay``, ``move_out`` or ``move_back``."""


class Drive:
    """One drive.

    Attributes
    ----------
    name, participant, condition : str
        Whose drive it is.
    rate_hz : float
        Rows a second.
    warnings : list of str
        What was left out, filled in or doubted when it was read.
    """

    def __init__(self, native: _native.Drive) -> None:
        self._native = native
        self.name = native.name
        self.participant = native.participant
        self.condition = native.condition
        self.rate_hz = native.rate_hz
        self.warnings = native.warnings

    @property
    def signals(self) -> Table:
        """The signals, a row a sample, units in the names; any data frame library takes it (``polars.DataFrame(d.signals)``)."""
        return Table(self._native.columns())

    def measures(self) -> dict[str, float | None]:
        """The objective measures by name; None where the drive has no such value."""
        return self._native.measures()

    def plot(self) -> _native.Figure:
        """Speed, gap and lane over time."""
        return self._native.plot()

    def _repr_svg_(self) -> str:
        return self._native._repr_svg_()

    def __len__(self) -> int:
        return len(self._native)

    def __repr__(self) -> str:
        return repr(self._native)


@dataclass(frozen=True)
class Driven:
    """A drive of a car, and what was counted in it.

    Attributes
    ----------
    drive : Drive
        What was driven.
    report : dict
        ``collisions``, ``rule_violations`` and ``inside_safe_distance_s`` of the safe distance, ``interventions`` of the safety
        layer, lane changes held, given up and started.
    """

    drive: Drive
    report: dict[str, float]


class Model:
    """What was learned of how people drive; made by `train` or `load`.

    Examples
    --------
    >>> import maveric
    >>> def at(mps):
    ...     def plan(scene):
    ...         ahead = scene["lead_id"] is not None and 0 < scene["lead_dx_m"] < 60
    ...         back = scene["lane"] > 0 and scene["lead_dx_m"] < -30
    ...         return mps, 40.0, "move_out" if ahead else "move_back" if back else "stay"
    ...     return plan
    >>> drives = [maveric.simulate(at(mps), duration_s=480, seed=mps, name=f"P{mps}").drive for mps in (25, 27, 29, 31)]
    >>> model = maveric.Model.train(drives)
    >>> [round(model.personalize(drive).predict()["free_speed_mps"]) for drive in drives]
    [25, 27, 29, 31]
    """

    def __init__(self, native: _native.Model) -> None:
        self._native = native

    @classmethod
    def train(
        cls,
        drives: Sequence[Drive],
        scores: Mapping[str, float] | None = None,
        *,
        score_range: tuple[float, float] | None = None,
        heads: str = "linear",
        embedding_size: int = 3,
        epochs: int = 40,
        seed: int = 1,
    ) -> Model:
        """Learn from drives.

        Parameters
        ----------
        drives : sequence of Drive
            One or more a driver.
        scores : mapping, optional
            A score of aggression by the drive's name or its participant's; without there is no dial.
        score_range : (float, float), optional
            Lowest and highest score that there can be; 11 to 55 points when not given. The dial turns in these points.
        heads : {"linear", "paper"}
            Habits as events, or the paper's five networks.
        embedding_size : int
            Numbers of a style.
        epochs : int
            Passes of the networks over the rows.
        seed : int
            Root of every random choice.
        """
        given = None if scores is None else {str(name): float(value) for name, value in scores.items()}
        drives_ = [d._native for d in drives]
        native = _native.Model.train(drives_, given, score_range, heads, embedding_size, epochs, seed)
        return cls(native)

    def personalize(self, drive: Drive, score: float | None = None) -> Style:
        """Solve for the style of a drive, the model as it is; `score` is read too where it is given."""
        return self._native.personalize(drive._native, score)

    def style(self, embedding: Sequence[float]) -> Style:
        """The style with these coordinates."""
        return self._native.style(list(embedding))

    @property
    def drivers(self) -> dict[str, Style]:
        """The styles of the drives that were learned from; none in a model from a file."""
        return self._native.drivers

    @property
    def mean_style(self) -> Style:
        """The style in the middle of those that were learned from."""
        return self._native.mean_style

    @property
    def knows_aggression(self) -> bool:
        """Whether there is a dial."""
        return self._native.knows_aggression

    @property
    def warnings(self) -> list[str]:
        """What the training left out, and why."""
        return self._native.warnings

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the model as a file that ``maveric`` reads."""
        beside = Path(f"{os.fspath(path)}.part")
        beside.write_bytes(self._native.to_bytes())
        beside.replace(path)

    @classmethod
    def load(cls, path: str | os.PathLike[str], *, score_range: tuple[float, float] | None = None) -> Model:
        """Read a model, from here or from ``maveric train``; its scores on `score_range`, or on the scale that it learned."""
        try:
            return cls(_native.Model.from_bytes(Path(path).read_bytes(), score_range))
        except OSError as error:
            raise Error(f"{os.fspath(path)}: {error.strerror}") from error

    def __repr__(self) -> str:
        return repr(self._native)


def read_log(
    path: str | os.PathLike[str],
    mapping: str | os.PathLike[str] | Mapping[str, Any] | None = None,
    *,
    rate_hz: float | None = None,
    recover: bool = False,
) -> list[Drive]:
    """Read the drives of a log.

    Parameters
    ----------
    path : path
        An MCAP recording, or a table (CSV, TSV, Parquet) with a mapping.
    mapping : path or dict, optional
        What columns or topics mean: a TOML file (``maveric inspect --suggest-mapping`` proposes one), or a dict with its keys.
    rate_hz : float, optional
        Rows a second of the result; 20 when not given.
    recover : bool
        Keep what is readable of a damaged recording.

    Raises
    ------
    Error
        Naming what was found, what was expected and what to do.

    Examples
    --------
    >>> import maveric, pathlib, tempfile
    >>> log = pathlib.Path(tempfile.mkdtemp(), "P01.csv")
    >>> _ = log.write_text("t,v,gap,lead\\n" + "".join(f"{i / 10},25,40,25\\n" for i in range(600)))
    >>> columns = {"time": "t", "ego_speed": "v", "gap": "gap", "lead_speed": "lead"}
    >>> units = {"time": "s", "length": "m", "speed": "m/s"}
    >>> table = {"layout": "pair", "gap_kind": "bumper_to_bumper", "units": units, "columns": columns}
    >>> (drive,) = maveric.read_log(log, {"table": table})
    >>> drive.measures()["mean_velocity_mps"]
    25.0
    """
    given = json.dumps(mapping) if isinstance(mapping, Mapping) else None
    file = None if isinstance(mapping, Mapping) else mapping
    return [Drive(native) for native in _native.read_log(path, file, given, rate_hz, recover)]


def _text(scenario: str | os.PathLike[str] | None) -> str | None:
    if scenario is None:
        return None
    try:
        return Path(scenario).read_text(encoding="utf-8")
    except OSError as error:
        raise Error(f"{os.fspath(scenario)}: {error.strerror}") from error


def simulate(
    planner: Style | AnyPlanner,
    scenario: str | os.PathLike[str] | None = None,
    *,
    duration_s: float | None = None,
    seed: int = 1,
    name: str = "car",
) -> Driven:
    """Drive in our simulator: a style, or anybody's planner, through the car's controllers and safety layer.

    Parameters
    ----------
    planner : Style or callable
        A callable is given, 20 times a second, a dict with ``time_s``, ``ego`` and ``vehicles`` (as `Vehicle`), ``lane``, ``lanes``,
        ``lane_width_m``, ``changing``, and ``lead_id``, ``lead_dx_m``, ``lead_dy_m``, ``lead_speed_mps`` of the vehicle that ego
        drives by. It gives a speed (m/s), a gap (m) and ``stay``, ``move_out`` or ``move_back``.
    scenario : path, optional
        A scenario file; the paper's when not given.
    duration_s : float, optional
        Length of the drive.
    seed : int
        Root of every random choice of the traffic.
    name : str
        What the drive is called.

    Examples
    --------
    >>> import maveric
    >>> driven = maveric.simulate(lambda scene: (27.0, 40.0, "stay"), duration_s=60)
    >>> driven.report["collisions"], round(driven.drive.measures()["lane_changes"])
    (0, 0)
    """
    drive, report = _native.simulate(planner, _text(scenario), duration_s, seed, name)
    return Driven(Drive(drive), report)


def drive_in(
    world: World,
    planner: Style | AnyPlanner,
    scenario: str | os.PathLike[str] | None = None,
    *,
    duration_s: float | None = None,
    name: str = "car",
) -> Driven:
    """Drive our car, by a style or any planner, in traffic that somebody else moves (SUMO, highway-env, a replay).

    Parameters
    ----------
    world : callable
        Given ego's x, y, speed and length, it moves everybody else on by 50 ms, and gives who is around; None ends the drive.
    planner, scenario, duration_s, name
        As for `simulate`; of the scenario count road, car, start and controllers.

    Examples
    --------
    >>> import itertools, maveric
    >>> row = itertools.count()
    >>> behind = lambda ego: [(1, 60.0 + 20.0 * 0.05 * next(row), 0.0, 20.0, 4.7)]
    >>> driven = maveric.drive_in(behind, lambda scene: (30.0, 35.0, "stay"), duration_s=60)
    >>> round(driven.drive.signals.to_dict()["ego_speed_mps"][-1])
    20
    """
    drive, report = _native.drive_in(world, planner, _text(scenario), duration_s, name)
    return Driven(Drive(drive), report)
