"""Orbits of a running sweep: as measured, 1X alone, and less the slow roll, each beside its time base."""

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from rotorrig.app.text import AmplitudeUnit
from rotorrig.app.viewer.live.data import POINTS, THETA, SlowRollSoFar, Waveform
from rotorrig.app.viewer.plots import UP, OrbitPicture, TimeBasePicture
from rotorrig.processing import Plane, planes
from rotorrig.rig.config import RigConfig

TURNS = 2  # the last ones: what orbits, time bases and present vectors are of
UNFILTERED = (128, 138, 150)
COMPENSATED = (126, 200, 120)
AROUND = np.linspace(0.0, 2 * np.pi, 73)  # rad: a turn of a filtered orbit


class OrbitsPart:
    """Orbit and time base of every probe plane."""

    def __init__(self, stream: rr.RecordingStream, rig: RigConfig, *, unit: AmplitudeUnit) -> None:
        self._by = unit.by_length
        self._planes = planes(rig)
        self._columns = [[rig.probes.index(rig.probe(name)) for name in plane.probes] for plane in self._planes]
        self._orbits = [OrbitPicture(stream, f"orbit/{i}", unit=unit) for i in range(len(self._planes))]
        self._time_bases = [
            TimeBasePicture(stream, f"time-base/{i}", probes=plane.probes, turns=TURNS, unit=unit)
            for i, plane in enumerate(self._planes)
        ]

    def draw(self, waveform: Waveform, slow_roll: SlowRollSoFar) -> None:
        """Draw the last turns, and what of them the slow roll explains left out."""
        shown = waveform.last(TURNS)
        x, z = shown.about_mean * self._by, first_order(shown) * self._by
        pictures = zip(self._planes, self._columns, self._orbits, self._time_bases, strict=True)
        for plane, columns, orbit, time_base in pictures:
            self._draw_orbits(orbit, plane, x[:, columns], z[columns], slow_roll, columns)
            millis = 2e3 * np.pi / shown.omega
            turn = (np.arange(len(x)) + 0.5) / POINTS - shown.turns
            time_base.draw(turn, x[:, columns], at_edges(x[:, columns]), words=f"one turn lasts {millis:.1f} ms")

    def _draw_orbits(
        self,
        picture: OrbitPicture,
        plane: Plane,
        x: NDArray[np.float64],
        z: NDArray[np.complex128],
        slow_roll: SlowRollSoFar,
        columns: list[int],
    ) -> None:
        """Draw one plane's `x` (point, 2) and 1X `z` (2,), both in the unit, along its probes."""
        orbits = [("unfiltered", x, UNFILTERED), ("1X", _turn_of_1x(z), UP)]
        if slow_roll.known:
            shape = np.tile(slow_roll.shape[:, columns] * self._by, (len(x) // POINTS, 1))
            orbits.append(("compensated", x - shape, COMPENSATED))
            orbits.append(("compensated-1X", _turn_of_1x(z - slow_roll.z[columns] * self._by), COMPENSATED))
        in_plane = [(name, line @ plane.to_xy.T, colour) for name, line, colour in orbits]
        dots = {name: _dots(name, line) for name, line, _ in in_plane}
        picture.draw(in_plane, dots)
        picture.caption(f"grey: all orders, blue: 1X, {'green: 1X less slow roll' if slow_roll.known else 'raw'}")
        picture.caption(slow_roll.words, name="compensated/caption")


def first_order(waveform: Waveform) -> NDArray[np.complex128]:
    """Return the 1X vectors (probe,) [m 0-peak] over the turns of a waveform, raw."""
    return 2 * np.einsum("tap,a->p", waveform.by_turn(), np.exp(-1j * THETA)) / (waveform.turns * POINTS)


def at_edges(x: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a waveform (turn * POINTS, column) at its keyphasor edges, (turn + 1, column), by straight lines."""
    places = np.arange(0, len(x) + 1, POINTS) - 0.5
    before = np.clip(np.floor(places).astype(np.intp), 0, len(x) - 2)
    return x[before] + (places - before)[:, None] * (x[before + 1] - x[before])


def _turn_of_1x(z: NDArray[np.complex128]) -> NDArray[np.float64]:
    """Return one turn (point, 2) of 1X alone."""
    return (np.exp(1j * AROUND)[:, None] * z).real


def _dots(name: str, line: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return where the keyphasor's edges are on an orbit: a filtered one begins at its edge."""
    return line[:1] if name.endswith("1X") else at_edges(line)
