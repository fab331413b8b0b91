"""Result plots that follow the speed cursor: orbits, the cursor itself, the rotor's deflection."""

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from rotorrig.app.plot_data import Plane, orbit, representative_rows, slow_roll_known
from rotorrig.app.viewer.plots import MARK, MODEL_UP, SOFT, UP, OrbitPicture, Panels, PolarPicture
from rotorrig.app.viewer.result.curves import CentrelineTrack
from rotorrig.app.viewer.result.data import Result
from rotorrig.app.viewer.result.rotor import RotorScene
from rotorrig.rig.config import RPM, UM

SPEEDS = 60
RECORDED = (96, 104, 112)  # all that the probes saw
RAW = (120, 150, 176)  # 1X before the slow-roll vector is taken off


def rows_to_show(result: Result) -> list[int]:
    """Return the rows the cursor can stand at: along the first sweep, the largest vector among them."""
    return representative_rows(result.response, result.z, run=result.sweeps[0], count=SPEEDS) if result.sweeps else []


def draw_by_speed(
    stream: rr.RecordingStream,
    result: Result,
    *,
    bodes: list[Panels],
    polars: list[PolarPicture],
    centrelines: list[CentrelineTrack],
    rotor: RotorScene,
) -> None:
    """Draw orbits, the cursor in every plot and the rotor's deflection at every speed shown."""
    pictures = [OrbitPicture(stream, f"orbit/{i}", unit=result.unit) for i in range(len(result.planes))]
    for step, row in enumerate(rows_to_show(result)):
        rpm = float(result.response.omega[row] * RPM)
        stream.set_time("speed_rpm", sequence=round(rpm))
        for (plane, columns), orbits_of in zip(result.planes, pictures, strict=True):
            orbits, dots = _orbits(result, row, plane, columns)
            orbits_of.draw(orbits, dots)
        for name, panels in zip(result.response.probes, bodes, strict=True):
            cursor = [panel.place(np.array([rpm, rpm]), np.array(panel.y)) for panel in panels]
            stream.log(f"bode/{name}/cursor", rr.LineStrips2D(cursor, colors=SOFT, radii=-0.6))
        for p, polar in enumerate(polars):
            polar.dots("cursor", result.z[[row], p], MARK, radius=5.0)
        for picture, path in centrelines:
            if path is not None:
                nearest = int(np.argmin(np.abs(path.rpm - rpm)))
                picture.dot(np.array([path.x[nearest], path.y[nearest]]) * result.unit.by_length / UM)
        rotor.at_speed(step)
    stream.reset_time()


def _orbits(
    result: Result, row: int, plane: Plane, columns: list[int]
) -> tuple[list[tuple[str, NDArray[np.float64], tuple[int, int, int]]], NDArray[np.float64]]:
    """Return the orbits of a plane at a row and their keyphasor dots, in the unit; the plainest lies at the bottom."""
    by = result.unit.by_length
    xy = orbit(plane, result.z[row, columns]) * by
    orbits = [("measured-1X", xy, UP)]
    if result.model is not None:
        orbits.append(("model-1X", orbit(plane, result.model[row, columns]) * by, MODEL_UP))
    if slow_roll_known(result.response):
        raw = orbit(plane, result.response.order(1.0)[row, columns]) * by
        orbits.insert(0, ("raw-1X", raw, RAW))
    if (recorded := _recorded_orbit(result, row, plane)) is not None:
        orbits.insert(0, ("recorded", recorded, RECORDED))
    return orbits, xy[:1]


def _recorded_orbit(result: Result, row: int, plane: Plane) -> NDArray[np.float64] | None:
    """Return two turns of the recorded orbit (point, 2), in the unit, about its mean at a row's time, if known."""
    pulses = result.response.keyphasor_t
    after = np.searchsorted(pulses, result.response.t[row])
    if result.waveforms is None or not 1 <= after < len(pulses) - 1:
        return None
    stretch = result.waveforms.between(*pulses[[after - 1, after + 1]])
    if stretch is None:
        return None
    names = [probe.name for probe in result.response.rig.probes]
    x = stretch.x[:, [names.index(name) for name in plane.probes]]
    return (x - x.mean(axis=0)) @ plane.to_xy.T * result.unit.by_length
