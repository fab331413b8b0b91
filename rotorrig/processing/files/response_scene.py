"""Scene and log of a response, which Rerun and Foxglove draw by themselves when they open `response.mcap`.

`/rig`: shaft, disks, bearings and probes, once. `/orbits`: the 1X orbits of every plane of probes in their place along
the shaft, over time, larger than they are. `/log`: what the runs are, and from where on rows are not usable.

The frame "rig" has X along the shaft from the coupling, Y along the rig's x (horizontal), Z along its y (up): metres.
"""

import math
import re
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from rotorrig.acquisition.files import INFO, LOG, POINT_CLOUD, WARNING, cloud_values, log_values
from rotorrig.processing.files.response_topics import Message, row_times
from rotorrig.processing.probe_planes import Plane, measured_planes
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.config import RPM, RigConfig

FRAME = "rig"
ORBIT_POINTS, DOT_POINTS = 60, 8
LARGEST_ORBIT = 0.1  # of the shaft's length: how large the largest one is drawn
PER_RUN = 150  # orbits of a run, about; rows between them make no message
RING_POINTS = 40
FIGURES = re.compile(r"\d+\.\d+")  # words that differ in these alone are said once
RISING, FALLING, DWELL, KEYPHASOR = (74, 163, 223), (242, 142, 43), (150, 158, 168), (240, 240, 240)
STEEL, DISK, BEARING, PROBE = (150, 158, 168), (96, 132, 168), (110, 118, 128), (242, 193, 78)
Reals = NDArray[np.float64]
Colour = tuple[int, int, int]
Piece = tuple[Reals, Colour]  # points (point, 3) [m]


def messages(response: OrderTrackedResponse) -> Iterator[Message]:
    """Yield rig, orbits and log of a response."""
    times = row_times(response)
    if not times:
        return
    yield "/rig", POINT_CLOUD, min(times), _cloud(min(times), _rig(response.rig))
    drawn = 1.0 in response.orders and not response.amplitudes_alone
    planes = list(measured_planes(response.rig, response.probes)) if drawn else []
    scale = exaggeration(response) if planes else 1.0
    for i in _rows_to_show(response) if planes else ():
        yield "/orbits", POINT_CLOUD, times[i], _cloud(times[i], _orbits(response, i, planes, scale))
    for i, level, words in _lines(response, scale if planes else None):
        yield "/log", LOG, times[i], log_values(times[i], _plain(words), level=level)


def exaggeration(response: OrderTrackedResponse) -> float:
    """Return the scale at which the 1X orbits are drawn, a round number."""
    size = np.abs(_vectors(response))[response.usable]
    largest = float(np.nanmax(size)) if np.isfinite(size).any() else 0.0
    if not largest > 0:
        return 1.0
    factor = LARGEST_ORBIT * response.rig.shaft.length / largest
    decade = 10.0 ** math.floor(math.log10(factor))
    return float(max(m * decade for m in (1, 2, 5) if m * decade <= factor * (1 + 1e-9)))


def _vectors(response: OrderTrackedResponse) -> NDArray[np.complex128]:
    """Return 1X less the slow roll where that is known of every probe, else raw, (row, probe) [m]."""
    known = np.isfinite(response.slow_roll[:, response.orders.index(1.0)]).all()
    return response.compensated(1.0) if known else response.order(1.0)


def _rows_to_show(response: OrderTrackedResponse) -> list[int]:
    """Return rows of every run at about even steps of speed; of a dwell, the first."""
    shown: list[int] = []
    for run in range(len(response.runs)):
        rows = np.flatnonzero((response.run == run) & response.usable.any(axis=1))
        if not len(rows):
            continue
        step = float(np.ptp(response.omega[rows])) / PER_RUN if response.runs[run].direction else math.inf
        last = -math.inf
        for i in rows:
            if abs(response.omega[i] - last) >= step or last == -math.inf:
                shown.append(int(i))
                last = float(response.omega[i])
    return shown


def _orbits(response: OrderTrackedResponse, i: int, planes: list[tuple[Plane, list[int]]], scale: float) -> list[Piece]:
    """Return the orbits of row `i`, and a dot on each at the keyphasor edge."""
    direction = response.runs[response.run[i]].direction
    colour = RISING if direction > 0 else FALLING if direction < 0 else DWELL
    theta = np.linspace(0.0, 2 * np.pi, ORBIT_POINTS, endpoint=False)
    z = _vectors(response)[i]
    pieces: list[Piece] = []
    for plane, places in planes:
        if not (response.usable[i, places].all() and np.isfinite(z[places]).all()):
            continue
        xy = scale * plane.to_xy @ (z[places, None] * np.exp(1j * theta)).real
        pieces.append((_at_position(plane.position, xy), colour))
        around = 0.004 * response.rig.shaft.length * np.exp(2j * np.pi * np.arange(DOT_POINTS) / DOT_POINTS)
        pieces.append((_at_position(plane.position, xy[:, :1] + np.array([around.real, around.imag])), KEYPHASOR))
    return pieces


def _rig(rig: RigConfig) -> list[Piece]:
    length, radius = rig.shaft.length, rig.shaft.diameter / 2
    z = np.linspace(0.0, length, 3 * RING_POINTS)
    pieces: list[Piece] = [(np.column_stack([z, 0 * z, 0 * z]), STEEL)]
    pieces += [(_ring(d.position + e * d.width / 2, d.diameter / 2), DISK) for d in rig.disks for e in (-1, 1)]
    pieces += [(_ring(bearing.position, 3 * radius), BEARING) for bearing in rig.bearings]
    for probe in rig.probes:
        reach = radius + np.linspace(0.002, 0.03, 12)
        pieces.append(
            (_at_position(probe.position, np.outer([math.cos(probe.angle), math.sin(probe.angle)], reach)), PROBE)
        )
    return pieces


def _ring(position: float, radius: float) -> Reals:
    theta = np.linspace(0.0, 2 * np.pi, RING_POINTS, endpoint=False)
    return _at_position(position, radius * np.array([np.cos(theta), np.sin(theta)]))


def _at_position(position: float, xy: Reals) -> Reals:
    """Return the points (point, 3) of the frame at x and y (2, point) `position` along the shaft."""
    return np.column_stack([np.full(xy.shape[1], position), xy[0], xy[1]])


def _cloud(t_ns: int, pieces: list[Piece]) -> dict[str, object]:
    points = np.concatenate([np.empty((0, 3)), *(points for points, _ in pieces)])
    colours = [np.tile(np.array(colour, dtype=np.uint8), (len(points), 1)) for points, colour in pieces]
    return dict(cloud_values(t_ns, points, np.concatenate([np.empty((0, 3), dtype=np.uint8), *colours]), frame=FRAME))


def _plain(words: str) -> str:
    """Return words in the characters of Latin-1: Rerun 0.41 ends at one that its font does not have."""
    return "".join(c if c.isprintable() and ord(c) < 0x100 else "?" for c in words)


def _lines(response: OrderTrackedResponse, scale: float | None) -> Iterator[tuple[int, int, str]]:
    """Yield row, level and text of the log: what is shown, where runs begin, where rows cease to be usable, remarks."""
    shown = "" if scale is None else f"; 1X orbits are drawn {scale:g} times larger, blue: speed rises, orange: falls"
    yield 0, INFO, f"{response.rig.name}: amplitudes 0-peak, phase lag from the keyphasor edge{shown}"
    before: tuple[str, ...] = ()
    for i in range(len(response.omega)):
        rpm = response.omega[i] * RPM
        run = response.runs[response.run[i]]
        if i == 0 or response.run[i] != response.run[i - 1]:
            way = {1: "speed rises", -1: "speed falls", 0: "speed held"}[run.direction]
            yield i, INFO, f"run '{run.name}' begins at {rpm:.0f} rpm, {way}"
        remarks = response.remarks[i] if response.remarks else ()
        words_by_level = tuple((WARNING, f"not usable: {why}") for why in response.reasons[i])
        words_by_level += tuple((INFO, f"remark: {why}") for why in remarks)
        for level, words in words_by_level:
            if FIGURES.sub("", words) not in before:
                yield i, level, f"{rpm:.0f} rpm, {words}"
        before = tuple(FIGURES.sub("", words) for _, words in words_by_level)
