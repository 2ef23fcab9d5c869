"""Our car in SUMO's traffic, and SUMO's drivers at the wheel in ours.

Needs ``pip install eclipse-sumo libsumo`` (``pip install maveric[sumo]``).
"""

from __future__ import annotations

import importlib
import subprocess
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ._native import MavericError as Error
from .driving import Ego, Vehicle

_STEP_S = 0.05
_EGO = "ego"
# Of the paper's road and car.
_LANE_M = 3.66
_LENGTH_M = 4.7
# Our car comes into the road no farther along than this, so that there is traffic before it for a drive of minutes.
_ENTRY_M = (200.0, 2500.0)
# Vehicles farther away than this are left out.
_SIGHT_M = 400.0
# How the car's velocity controller answers a wish: 0.6 m/s² for each m/s.
_GAIN_PER_S = 0.6


def _libsumo() -> tuple[Any, Path]:
    """The library, and the folder of its programs."""
    try:
        libsumo, sumo = (importlib.import_module(name) for name in ("libsumo", "sumo"))
    except ImportError as error:
        raise Error(f"SUMO is not here ({error}): pip install eclipse-sumo libsumo") from error
    return libsumo, Path(sumo.SUMO_HOME) / "bin"


class Highway:
    """A highway in SUMO as a world of `drive_in`: its vehicles see our car and react to it; our car goes where it is driven.

    Parameters
    ----------
    vehicles_per_hour : float
        Traffic that enters, over all lanes.
    speed_mps, speed_sd : float
        What SUMO's drivers would like to drive, and how much they differ, as a share.
    lanes : int
        As many as the scenario has.
    model : str
        SUMO's car-following model of the traffic (``IDM``, ``Krauss``, ``EIDM``, ...).
    warm_up_s : float
        Traffic before our car comes.
    seed : int
        Of SUMO.

    Attributes
    ----------
    collisions : int
        Collisions that SUMO counted of our car.

    Examples
    --------
    ``with maveric.sumo.Highway(seed=3) as world: driven = maveric.drive_in(world, style, duration_s=300)``
    """

    def __init__(
        self,
        *,
        vehicles_per_hour: float = 900.0,
        speed_mps: float = 24.6,
        speed_sd: float = 0.08,
        lanes: int = 2,
        model: str = "IDM",
        warm_up_s: float = 300.0,
        seed: int = 1,
    ) -> None:
        self._sumo, programs = _libsumo()
        self._ids: dict[str, int] = {}
        self._hit: set[str] = set()
        self._start_m: float | None = None
        self._lanes = lanes
        self._files = tempfile.TemporaryDirectory()
        folder = Path(self._files.name)
        (folder / "n.nod.xml").write_text('<nodes><node id="a" x="0" y="0"/><node id="b" x="60000" y="0"/></nodes>')
        (folder / "n.edg.xml").write_text(
            f'<edges><edge id="e" from="a" to="b" numLanes="{lanes}" speed="{speed_mps}" width="{_LANE_M}"/></edges>'
        )
        slow = f'speedFactor="normc(1,{speed_sd},{1 - 3 * speed_sd},{1 + 3 * speed_sd})"'
        (folder / "r.rou.xml").write_text(
            f'<routes><vType id="t" length="{_LENGTH_M}" carFollowModel="{model}" {slow}/>'
            f'<vType id="ego" length="{_LENGTH_M}" maxSpeed="60"/><route id="r" edges="e"/>'
            f'<flow id="f" type="t" route="r" begin="0" end="100000" vehsPerHour="{vehicles_per_hour}"'
            ' departLane="best" departSpeed="desired" departPos="0"/></routes>'
        )
        made = subprocess.run(
            [
                programs / "netconvert",
                *("-n", folder / "n.nod.xml", "-e", folder / "n.edg.xml", "-o", folder / "n.net.xml"),
            ],
            capture_output=True,
            text=True,
            check=False,
        )
        if made.returncode:
            raise Error(f"SUMO's netconvert failed: {made.stderr.strip()[-300:]}")
        self._sumo.start(
            [
                "sumo",
                *("-n", str(folder / "n.net.xml"), "-r", str(folder / "r.rou.xml")),
                *("--step-length", str(_STEP_S), "--seed", str(seed), "--no-step-log", "--no-warnings"),
                *("--collision.action", "warn", "--collision.check-junctions", "false"),
            ]
        )
        for _ in range(round(warm_up_s / _STEP_S)):
            self._sumo.simulationStep()

    def __call__(self, ego: Ego) -> Sequence[Vehicle] | None:
        """Put our car where it is, let SUMO move everybody else by 50 ms, and say who is around."""
        x_m, y_m, speed_mps, length_m = ego
        vehicle = self._sumo.vehicle
        right_m = -(self._lanes - 0.5) * _LANE_M
        if self._start_m is None:
            self._enter(speed_mps)
        assert self._start_m is not None
        front_m = self._start_m + x_m + length_m / 2
        vehicle.moveToXY(_EGO, "e", -1, front_m, right_m + y_m, 90.0, 2)
        vehicle.setSpeed(_EGO, speed_mps)
        self._sumo.simulationStep()
        if _EGO not in vehicle.getIDList():
            return None
        for collision in self._sumo.simulation.getCollisions():
            if _EGO in (collision.collider, collision.victim):
                self._hit.add(collision.victim if collision.collider == _EGO else collision.collider)
        around = []
        for name in vehicle.getIDList():
            if name == _EGO:
                continue
            front, side = vehicle.getPosition(name)
            length = vehicle.getLength(name)
            x = front - length / 2 - self._start_m
            if abs(x - x_m) <= _SIGHT_M:
                known = self._ids.setdefault(name, len(self._ids) + 1)
                around.append((known, x, side - right_m, vehicle.getSpeed(name), length))
        return around

    def _enter(self, speed_mps: float) -> None:
        """Our car comes into the middle of the largest hole of the right lane, at the speed at which it starts."""
        vehicle = self._sumo.vehicle
        taken = sorted(vehicle.getPosition(v)[0] for v in vehicle.getIDList() if vehicle.getLaneIndex(v) == 0)
        taken = [x for x in taken if _ENTRY_M[0] < x < _ENTRY_M[1]] or [1000.0]
        holes = [(b - a, (a + b) / 2) for a, b in zip(taken, taken[1:])]
        self._start_m = max(holes)[1] if holes else taken[-1] / 2
        vehicle.add(_EGO, "r", "ego", departLane="0", departPos=str(self._start_m), departSpeed=str(speed_mps))
        vehicle.setSpeedMode(_EGO, 0)
        vehicle.setLaneChangeMode(_EGO, 0)

    @property
    def collisions(self) -> int:
        """Vehicles that our car has collided with, as SUMO counts."""
        return len(self._hit)

    def close(self) -> None:
        """End SUMO."""
        self._sumo.close()
        self._files.cleanup()

    def __enter__(self) -> Highway:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


class Follower:
    """A driver of SUMO as a planner of `simulate`: asks SUMO's own car-following model how fast to go behind the lead.

    Parameters
    ----------
    model : str
        SUMO's car-following model.
    speed_mps : float
        The speed that it would like to drive.
    """

    def __init__(self, model: str = "IDM", speed_mps: float = 30.0) -> None:
        # A road of its own, on which one car of the model stands ready to be asked.
        self._world = Highway(vehicles_per_hour=60, speed_mps=speed_mps, speed_sd=1e-6, model=model, warm_up_s=61.0)
        self._sumo = self._world._sumo
        self._name = self._sumo.vehicle.getIDList()[0]
        self._free_mps = speed_mps

    def __call__(self, scene: dict[str, Any]) -> tuple[float, float, str]:
        """Speed, gap and to stay."""
        speed = scene["ego"][3]
        ahead = scene["lead_id"] is not None and scene["lead_dx_m"] > 0 and abs(scene["lead_dy_m"]) < _LANE_M / 2
        gap = scene["lead_dx_m"] if ahead else 1000.0
        lead = scene["lead_speed_mps"] if ahead else self._free_mps
        wanted = self._sumo.vehicle.getFollowSpeed(self._name, speed, gap, lead, 4.5, "")
        accel = (wanted - speed) / _STEP_S
        return max(0.0, speed + accel / _GAIN_PER_S), 2.0 + speed, "stay"

    def close(self) -> None:
        """End SUMO."""
        self._world.close()
