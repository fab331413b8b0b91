"""Full spectra of a running sweep: one per step of speed and direction, for the cascade."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotorrig.app.viewer.live.data.tracker import KEPT_TURNS
from rotorrig.app.viewer.live.data.waveform import Waveform
from rotorrig.app.viewer.plots import fastest_rpm
from rotorrig.processing import planes
from rotorrig.processing.tracking import full_spectrum
from rotorrig.rig.config import RPM, RigConfig

ROWS = 40  # of a cascade from rest to the fastest speed


@dataclass(frozen=True, slots=True, kw_only=True)
class Cascade:
    """Full spectra of one plane in one direction, in the order of measurement."""

    rpm: NDArray[np.float64]  # (row,)
    order: NDArray[np.float64]  # (bin,) from -N to N
    amplitude: NDArray[np.float64]  # (row, bin) m 0-peak


class SpectraSoFar:
    """Keeps a full spectrum of every plane whenever the speed has moved by a step."""

    def __init__(self, rig: RigConfig) -> None:
        self.planes = planes(rig)
        self._columns = [[rig.probes.index(rig.probe(name)) for name in plane.probes] for plane in self.planes]
        self._rotation = rig.rotation
        self._step = fastest_rpm(rig) / ROWS
        self._order = np.empty(0)
        self._rows: dict[int, list[tuple[float, NDArray[np.float64]]]] = {1: [], -1: []}  # rpm, (plane, bin) m

    def add(self, waveform: Waveform, *, direction: int) -> None:
        """Take the spectrum of the last turns if the speed has moved far enough since the last one."""
        rows, rpm = self._rows[direction], waveform.omega * RPM
        if waveform.turns < KEPT_TURNS or (rows and abs(rows[-1][0] - rpm) < self._step) or not self.planes:
            return
        amplitude = []
        for plane, columns in zip(self.planes, self._columns, strict=True):
            self._order, spectrum = full_spectrum(
                waveform.x[:, columns], plane=plane, rotation=self._rotation, turns=waveform.turns
            )
            amplitude.append(spectrum)
        rows.append((rpm, np.array(amplitude)))

    def count(self, direction: int) -> int:
        """Return how many spectra a direction has."""
        return len(self._rows[direction])

    def cascade(self, plane: int, *, direction: int) -> Cascade:
        """Return the spectra of the plane with that index, of which there must be some."""
        rows = self._rows[direction]
        amplitude = np.array([by_plane[plane] for _, by_plane in rows])
        return Cascade(rpm=np.array([rpm for rpm, _ in rows]), order=self._order, amplitude=amplitude)
