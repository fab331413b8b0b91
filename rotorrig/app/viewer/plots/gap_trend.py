"""The gap voltages of all probes over time in Rerun, between the ends of the range in which a probe is linear."""

from collections.abc import Sequence

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from rotorrig.app.viewer.plots.axes import SOFT
from rotorrig.rig.config import Probe

PROBE_COLOURS = ((74, 163, 223), (242, 142, 43), (126, 200, 120), (214, 120, 200))


class GapTrendPicture:
    """Volts per probe, and lines at both ends of each linear range the probes have, for a TimeSeriesView."""

    def __init__(self, stream: rr.RecordingStream, path: str, *, probes: Sequence[Probe]) -> None:
        self._stream = stream
        self._path = path
        self._probes = tuple(probes)
        self._ends = sorted({end for probe in probes for end in probe.linear_range})
        for i, probe in enumerate(probes):
            colour = PROBE_COLOURS[i % len(PROBE_COLOURS)]
            style = rr.SeriesLines(colors=colour, widths=1.6, names=f"{probe.name}, V")
            stream.log(f"{path}/{probe.name}", style, static=True)
        for end in self._ends:
            style = rr.SeriesLines(colors=SOFT, widths=1.2, names=f"end of the linear range, {end:g} V")
            stream.log(self._end_path(end), style, static=True)

    def draw(self, volts: NDArray[np.float64]) -> None:
        """Add volts (probe,) at the stream's present time."""
        for probe, value in zip(self._probes, volts.tolist(), strict=True):
            self._stream.log(f"{self._path}/{probe.name}", rr.Scalars(value))
        for end in self._ends:
            self._stream.log(self._end_path(end), rr.Scalars(end))

    def _end_path(self, end: float) -> str:
        return f"{self._path}/range/{end:g}".replace("-", "minus_")
