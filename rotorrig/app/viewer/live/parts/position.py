"""Shaft position during a sweep: centreline of every plane over speed, gap voltages over time."""

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from rotorrig.app.plot_data import SMALLEST_PATH
from rotorrig.app.text import AmplitudeUnit
from rotorrig.app.viewer.live.data import WAYS, Points, SpeedCurves
from rotorrig.app.viewer.live.parts.vectors import COLOURS, NAMES
from rotorrig.app.viewer.plots import CentrelinePicture, GapTrendPicture, displayable, speed_marks
from rotorrig.processing import planes
from rotorrig.rig.config import UM, Bearing, RigConfig

LABELS_APART = 0.3  # of the reach of the path, or half that of the smallest axes


class CentrelinesPart:
    """The centreline of every probe plane, from where the shaft lay when the first turns were seen."""

    def __init__(self, stream: rr.RecordingStream, rig: RigConfig, *, static: bool, unit: AmplitudeUnit) -> None:
        self._stream = stream
        self._by = unit.by_length
        self._planes = planes(rig)
        self._columns = [[rig.probes.index(rig.probe(name)) for name in plane.probes] for plane in self._planes]
        self._first: NDArray[np.float64] | None = None  # (probe,) m
        self._pictures = []
        for i, plane in enumerate(self._planes):
            bearing = bearing_near(rig, plane.position)
            clearance = None if bearing.clearance is None else bearing.clearance * self._by
            words = f"; circle: clearance of bearing '{displayable(bearing.name)}'" if clearance else ""
            words += f", {clearance:.3g} {unit.length}" if clearance else ""
            self._pictures.append(
                CentrelinePicture(
                    stream,
                    f"centreline/{i}",
                    clearance=clearance,
                    gravity=rig.gravity,
                    title=f"y, {unit.length}{words}",
                    static=static,
                    unit=unit,
                )
            )

    def draw(self, curves: SpeedCurves) -> None:
        """Draw the paths as they are now."""
        drawn = {way: curves.points(way) for way in WAYS if curves.count(way)}
        if self._first is None:
            self._first = next(iter(drawn.values())).gap[0]
        for i, picture in enumerate(self._pictures):
            paths = {way: self._place(i, points.gap) for way, points in drawn.items()}
            way = max(drawn, key=lambda way: len(drawn[way].rpm))
            picture.draw(
                [(NAMES[way], xy, COLOURS[way]) for way, xy in paths.items()],
                labels=self._speeds(drawn[way], paths[way]),
            )

    def now(self, gap: NDArray[np.float64]) -> None:
        """Draw a dot at the present mean positions (probe,) [m]; nothing before the first turns."""
        if self._first is not None:
            for i, picture in enumerate(self._pictures):
                picture.dot(self._place(i, gap[None])[0])

    def _place(self, plane: int, gap: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return x and y (point, 2) in the unit of mean positions (point, probe) [m] from the reference."""
        assert self._first is not None
        return (gap - self._first)[:, self._columns[plane]] @ self._planes[plane].to_xy.T * self._by

    def _speeds(self, points: Points, xy: NDArray[np.float64]) -> list[tuple[float, float, str]]:
        """Return words with the speed at points along a path (point, 2) in the unit."""
        reach = max(float(np.abs(xy).max()), SMALLEST_PATH / UM * self._by / 2)
        at = speed_marks(points.rpm, xy[:, 0] + 1j * xy[:, 1], apart=LABELS_APART * reach)
        return [(float(xy[i, 0]), float(xy[i, 1]), f"{round(float(points.rpm[i]), -1):.0f} rpm") for i in at]


class GapsPart:
    """The gap voltages over time."""

    def __init__(self, stream: rr.RecordingStream, rig: RigConfig) -> None:
        self._picture = GapTrendPicture(stream, "gap", probes=rig.probes)
        self._volts = np.array([(probe.gap_voltage, probe.sensitivity) for probe in rig.probes])

    def draw(self, gap: NDArray[np.float64]) -> None:
        """Add mean positions (probe,) [m] at the stream's present time."""
        self._picture.draw(self.volts(gap))

    def volts(self, gap: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return what the probes read [V] at mean positions (probe,) [m]."""
        return self._volts[:, 0] + self._volts[:, 1] * gap


def bearing_near(rig: RigConfig, position: float) -> Bearing:
    """Return the bearing nearest to a position [m] along the shaft."""
    return min(rig.bearings, key=lambda bearing: abs(bearing.position - position))
