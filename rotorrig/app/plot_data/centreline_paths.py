"""Shaft centreline paths over a sweep, per probe plane, and bearing clearance circles, in micrometres."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotorrig.app.plot_data.curves import sweeps
from rotorrig.app.plot_data.nice_numbers import nice
from rotorrig.processing import OrderTrackedResponse, measured_planes
from rotorrig.rig.config import RPM, UM, RigConfig, micrometres

REFERENCE = 8  # rows, the slowest of a run: where its path begins
SMALLEST_PATH = 5.0  # µm, half width of the axes where there is no circle: noise of less is no motion to look into
SEEN = 0.02  # of the circle's radius: a shorter path would be a dot in it, and is drawn without it
BEYOND = 1.12  # of the circle's radius: half width of the axes around it


@dataclass(frozen=True, slots=True, kw_only=True)
class CentrelinePath:
    """One run in one plane of probes."""

    plane: str
    position: float  # m, of the plane
    run: str
    direction: int  # +1 speed rises, -1 falls
    rpm: NDArray[np.float64]  # (row,)
    x: NDArray[np.float64]  # (row,) um from where the shaft is while the run is slowest
    y: NDArray[np.float64]

    @property
    def reach(self) -> float:
        """Largest distance from the start [m], smoothed by a moving mean of three rows."""
        away = np.convolve(self.x + 1j * self.y, np.ones(3) / 3, mode="valid")
        return float(np.abs(away).max()) / UM


def centreline_paths(response: OrderTrackedResponse) -> tuple[CentrelinePath, ...]:
    """Return the paths of every plane of two probes; none if the gap (0X) was not tracked."""
    if 0.0 not in response.orders:
        return ()
    gap = response.order(0.0).real
    paths = []
    for plane, pair in measured_planes(response.rig, response.probes):
        for i in sweeps(response):
            usable = response.usable[:, pair].all(axis=1) & np.isfinite(gap[:, pair]).all(axis=1)
            rows = np.flatnonzero((response.run == i) & usable)
            if len(rows) <= REFERENCE:
                continue
            slowest = rows[np.argsort(response.omega[rows])[:REFERENCE]]
            x, y = ((gap[rows][:, pair] - gap[slowest][:, pair].mean(axis=0)) @ plane.to_xy.T).T * UM
            paths.append(
                CentrelinePath(
                    plane=plane.name,
                    position=plane.position,
                    run=response.runs[i].name,
                    direction=response.runs[i].direction,
                    rpm=response.omega[rows] * RPM,
                    x=x,
                    y=y,
                )
            )
    return tuple(paths)


@dataclass(frozen=True, slots=True, kw_only=True)
class ClearanceCircle:
    """Clearance circle of a bearing, the journal at its slowest taken to lie at the bottom.

    Bently and Hatch, Fundamentals of Rotating Machinery Diagnostics (2002), ch. 6.
    """

    bearing: str
    radius: float  # µm
    x: float  # µm, of its centre from where the path begins
    y: float


def clearance_circle(rig: RigConfig, position: float) -> ClearanceCircle | None:
    """Return the circle of the bearing nearest to a plane of probes; None if its clearance is not known."""
    bearing = min(rig.bearings, key=lambda bearing: abs(bearing.position - position))
    if bearing.clearance is None:
        return None
    radius = bearing.clearance / 2 * UM
    x, y = {"-y": (0.0, radius), "-x": (radius, 0.0), "none": (0.0, 0.0)}[rig.gravity]
    return ClearanceCircle(bearing=bearing.name, radius=radius, x=x, y=y)


def is_seen_in(paths: Sequence[CentrelinePath], circle: ClearanceCircle | None) -> bool:
    """Return whether the paths are large enough to be seen in the circle, if there is one."""
    return circle is not None and any(np.hypot(path.x, path.y).max() > SEEN * circle.radius for path in paths)


def half_width(paths: Sequence[CentrelinePath], circle: ClearanceCircle | None) -> float:
    """Return half the width [µm] of square axes that hold the paths: about the circle if they are seen in it, else 0.

    >>> half_width([], None)
    5.0
    """
    x, y, radius = (circle.x, circle.y, circle.radius) if circle and is_seen_in(paths, circle) else (0.0, 0.0, 0.0)
    reach = max((float(np.abs([path.x - x, path.y - y]).max()) for path in paths), default=0.0)
    return nice(max(1.05 * reach, BEYOND * radius, SMALLEST_PATH))


def centreline_words(paths: tuple[CentrelinePath, ...]) -> str:
    """Say how far the shaft goes in every plane and run."""
    return " ".join(f"{path.plane}, {path.run} run: up to {micrometres(path.reach)} µm." for path in paths)
