"""Curves over speed of a running sweep: turns pooled into points by speed, rising and falling apart."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotorrig.app.viewer.live.data.tracker import Turns
from rotorrig.rig.config import RPM

POINT_TURNS = 8  # averaged into one point
APART = 4.0  # rpm between points
TURN_BACK = 12.0  # rpm against the trend before the direction is taken to have changed
WAYS = (1, -1)


@dataclass(frozen=True, slots=True, kw_only=True)
class Points:
    """A curve of one direction, in the order of measurement."""

    rpm: NDArray[np.float64]  # (point,)
    z: NDArray[np.complex128]  # (point, probe) m 0-peak, raw 1X
    gap: NDArray[np.float64]  # (point, probe) m


class SpeedCurves:
    """Collects turns into curves over speed, one rising and one falling; a later sweep goes on in the same two."""

    def __init__(self) -> None:
        self.direction = 1  # +1 speed rises, -1 falls
        self.latest: tuple[float, NDArray[np.complex128], NDArray[np.float64]] | None = None  # rpm, z, gap of a point
        self._points: dict[int, list[tuple[float, NDArray[np.complex128], NDArray[np.float64]]]] = {1: [], -1: []}
        self._waiting: list[tuple[float, NDArray[np.complex128], NDArray[np.float64]]] = []
        self._furthest = 0.0  # rpm, in the present direction

    def add(self, turns: Turns) -> None:
        """Add turns that have ended."""
        for turn in zip((turns.omega * RPM).tolist(), turns.z, turns.gap, strict=True):
            self._waiting.append(turn)
            if len(self._waiting) == POINT_TURNS:
                self._pool()

    def count(self, direction: int) -> int:
        """Return how many points a direction has."""
        return len(self._points[direction])

    def points(self, direction: int) -> Points:
        """Return the curve of one direction, which must have points."""
        pooled = self._points[direction]
        return Points(
            rpm=np.array([rpm for rpm, *_ in pooled]),
            z=np.array([z for _, z, _ in pooled]),
            gap=np.array([gap for *_, gap in pooled]),
        )

    def _pool(self) -> None:
        rpm = float(np.mean([speed for speed, *_ in self._waiting]))
        z = np.mean([z for _, z, _ in self._waiting], axis=0)
        gap = np.mean([gap for *_, gap in self._waiting], axis=0)
        self._waiting.clear()
        self.latest = rpm, z, gap
        if self.direction * (self._furthest - rpm) > TURN_BACK:
            self.direction, self._furthest = -self.direction, rpm
        elif self.direction * (rpm - self._furthest) > 0:
            self._furthest = rpm
        curve = self._points[self.direction]
        if not curve or abs(curve[-1][0] - rpm) >= APART:
            curve.append(self.latest)
