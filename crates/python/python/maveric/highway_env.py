"""Our car in the traffic of highway-env (Leurent 2018).

Needs ``pip install highway-env`` (``pip install maveric[highway-env]``).
"""

from __future__ import annotations

import importlib
import math
from collections.abc import Sequence
from typing import Any

from ._native import MavericError as Error
from .driving import Ego, Vehicle

_STEP_S = 0.05
# Lanes of the paper's road; those of highway-env are drawn together onto them.
_LANE_M = 3.66
_SIGHT_M = 250.0
# Who is farther away comes again at the other end.
_AWAY_M = 320.0
_ROOM_M = 40.0


class Highway:
    """``highway-v0`` as a world of `drive_in`: its vehicles (IDM and MOBIL) see our car and react to it.

    Parameters
    ----------
    vehicles : int
        Vehicles around our car; who is left 320 m behind comes again as far ahead, and the other way round.
    lanes : int
        As many as the scenario has.
    speed_mps : tuple of float
        What its drivers would like to drive, from and to.
    seed : int
        Of the environment.

    Attributes
    ----------
    collisions : int
        Collisions that highway-env saw of our car.
    """

    def __init__(
        self, *, vehicles: int = 8, lanes: int = 2, speed_mps: tuple[float, float] = (21.0, 28.0), seed: int = 1
    ) -> None:
        try:
            gymnasium, _ = (importlib.import_module(name) for name in ("gymnasium", "highway_env"))
        except ImportError as error:
            raise Error(f"highway-env is not here ({error}): pip install highway-env") from error
        self._lanes = lanes
        made: Any = gymnasium.make(
            "highway-v0",
            config={"lanes_count": lanes, "vehicles_count": vehicles, "simulation_frequency": round(1 / _STEP_S)},
        )
        self._env = made.unwrapped
        self._env.reset(seed=seed)
        self._ego = self._env.vehicle
        self._others = [v for v in self._env.road.vehicles if v is not self._ego]
        self._start_m = float(self._ego.position[0])
        self._hit: set[int] = set()
        low, high = speed_mps
        # highway-env lets everybody come from behind our car's place: spread them over the road instead.
        for i, vehicle in enumerate(self._others):
            ahead = 2 * _SIGHT_M * (i + 0.5) / len(self._others) - _SIGHT_M
            lane = i % lanes
            vehicle.position[:] = (self._start_m + ahead, 4.0 * lane)
            vehicle.lane_index = vehicle.target_lane_index = ("0", "1", lane)
            vehicle.lane = self._env.road.network.get_lane(vehicle.lane_index)
            vehicle.target_speed = low + (high - low) * float(self._env.np_random.uniform())
            vehicle.speed = vehicle.target_speed

    def __call__(self, ego: Ego) -> Sequence[Vehicle]:
        """Put our car where it is, let the others drive on by 50 ms, and say who is around."""
        x_m, y_m, speed_mps, _ = ego
        road, own = self._env.road, self._ego
        self._place(x_m, y_m, speed_mps)
        own.crashed = False
        for vehicle in self._others:
            vehicle.act()
        for vehicle in self._others:
            vehicle.step(_STEP_S)
        self._place(x_m, y_m, speed_mps)
        self._bring_back(x_m)
        for i, vehicle in enumerate(self._others):
            own.handle_collisions(vehicle, _STEP_S)
            if own.crashed:
                self._hit.add(i)
                own.crashed = vehicle.crashed = False
        assert own in road.vehicles
        around = []
        for i, vehicle in enumerate(self._others):
            x = float(vehicle.position[0]) - self._start_m
            if abs(x - x_m) <= _SIGHT_M:
                # Its lanes are 4 m wide and counted from the left, y to the right.
                y = (self._lanes - 1) * _LANE_M - float(vehicle.position[1]) / 4.0 * _LANE_M
                around.append((i + 1, x, y, float(vehicle.speed), float(vehicle.LENGTH)))
        return around

    def _bring_back(self, x_m: float) -> None:
        for vehicle in self._others:
            away = float(vehicle.position[0]) - self._start_m - x_m
            if abs(away) <= _AWAY_M:
                continue
            there = self._start_m + x_m - math.copysign(_AWAY_M, away)
            same = [v for v in self._others if v is not vehicle and v.lane_index == vehicle.lane_index]
            if all(abs(float(v.position[0]) - there) > _ROOM_M for v in same):
                vehicle.position[0] = there

    def _place(self, x_m: float, y_m: float, speed_mps: float) -> None:
        own, network = self._ego, self._env.road.network
        own.position[:] = (self._start_m + x_m, ((self._lanes - 1) * _LANE_M - y_m) / _LANE_M * 4.0)
        own.speed, own.heading = speed_mps, 0.0
        own.lane_index = network.get_closest_lane_index(own.position, own.heading)
        own.lane = network.get_lane(own.lane_index)
        own.impact = None

    @property
    def collisions(self) -> int:
        """Vehicles that our car has collided with, as highway-env counts."""
        return len(self._hit)

    def close(self) -> None:
        """End the environment."""
        self._env.close()

    def __enter__(self) -> Highway:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
