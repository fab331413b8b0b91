"""What a sweep looks like as it runs: orbits, growing Bode plots, speed and time base, drawn into a Rerun stream."""

import dataclasses

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from rotorrig.app.curves import phase_window
from rotorrig.app.drawn_axes import DOWN, MARK, UP
from rotorrig.app.live_tracking import GrowingBode, LiveTracker, Waveform
from rotorrig.app.rerun_pictures import BodePicture, OrbitPicture, fastest_rpm
from rotorrig.processing.probe_planes import Plane, planes
from rotorrig.rig.description import RigConfig
from rotorrig.rig.probes.base import Block, DaqInfo
from rotorrig.rig.units import RPM, UM

OLDER = (52, 96, 128)  # the turns before the last
PER_TURN = 64  # points of a turn that are drawn, at least
BODE_EVERY = 1.0  # s of the sample clock: the whole curve is sent each time
PROBE_COLOURS = ((74, 163, 223), (242, 142, 43), (126, 200, 120), (214, 120, 200))


class LiveScene:
    """Takes every block, draws when asked to."""

    def __init__(self, rig: RigConfig, info: DaqInfo, stream: rr.RecordingStream) -> None:
        self._stream = stream
        self._probes = tuple(probe.name for probe in rig.probes)
        self._tracker = LiveTracker(rig, info)
        self._bode = GrowingBode()
        self._grown, self._bode_due = False, 0.0
        self._planes = planes(rig)
        self._orbits = [OrbitPicture(stream, f"orbit/{i}") for i in range(len(self._planes))]
        top = fastest_rpm(rig)
        self._bodes = [
            BodePicture(stream, f"bode/{n}", title=f"{n}: 1X amplitude, raw, µm 0-peak", fastest=top)
            for n in self._probes
        ]
        self._shown_until = 0.0  # s of waveform already drawn
        self._style()

    def take(self, block: Block) -> None:
        """Track the next block."""
        self._grown |= self._bode.add(*self._tracker.take(block))

    def draw(self, *, last: bool = False) -> None:
        """Draw the present state at the present time of the sample clock; the `last` picture leaves nothing out."""
        self._stream.set_time("time", duration=self._tracker.time)
        self._stream.log("speed/keyphasor", rr.Scalars(self._tracker.speed * RPM))
        if self._grown and (last or self._tracker.time >= self._bode_due):
            self._draw_bodes()
            self._grown, self._bode_due = False, self._tracker.time + BODE_EVERY
        if (waveform := _thinned(self._tracker.waveform())) is not None:
            for plane, picture in zip(self._planes, self._orbits, strict=True):
                self._draw_orbit(plane, picture, waveform)
            self._draw_time_base(waveform)

    def _style(self) -> None:
        self._stream.log("speed/keyphasor", rr.SeriesLines(colors=UP, widths=1.5, names="speed, rpm"), static=True)
        for i, name in enumerate(self._probes):
            colour = PROBE_COLOURS[i % len(PROBE_COLOURS)]
            self._stream.log(f"waveform/{name}", rr.SeriesLines(colors=colour, widths=1.2, names=name), static=True)
            marks = rr.SeriesPoints(colors=MARK, markers="circle", marker_sizes=3.0, names="keyphasor")
            self._stream.log(f"waveform/{name}/keyphasor", marks, static=True)
        for picture in self._bodes:
            picture.panels(0.0, 0.0)

    def _draw_bodes(self) -> None:
        drawn = {way: self._bode.arrays(way) for way in (1, -1) if self._bode.points[way]}
        fastest = max(float(rpm.max()) for rpm, _ in drawn.values())
        both = np.concatenate([z for _, z in drawn.values()])
        for p, picture in enumerate(self._bodes):
            panels = picture.panels(float(np.abs(both[:, p]).max()) * UM, fastest, lag_from=phase_window(both[:, p]))
            for way, (rpm, z) in drawn.items():
                name, colour, order = ("up", UP, 2.0) if way > 0 else ("down", DOWN, 3.0)
                picture.line(name, panels, rpm, z[:, p], colour, order=order)
            rpm, z = drawn[self._bode.direction]
            picture.dots("now", panels, rpm[-1:], z[-1:, p], MARK, radius=4.0, order=4.0)

    def _draw_orbit(self, plane: Plane, picture: OrbitPicture, waveform: Waveform) -> None:
        columns = [self._probes.index(name) for name in plane.probes]
        xy = waveform.x[:, columns] @ plane.to_xy.T * UM
        last = waveform.t >= waveform.edges[-2]
        at_edges = np.column_stack([np.interp(waveform.edges, waveform.t, xy[:, i]) for i in (0, 1)])
        orbits = [("older", xy[~last], OLDER)] if not last.all() else []
        picture.draw([*orbits, ("last-turn", xy[last], UP)], at_edges)

    def _draw_time_base(self, waveform: Waveform) -> None:
        """Send what is new, with a break where turns were left out."""
        t, x = waveform.t, waveform.x * UM
        new, edges = t > self._shown_until, waveform.edges[waveform.edges > self._shown_until]
        t, x = t[new], x[new]
        if not len(t):
            return
        if t[0] - self._shown_until > 2 * (waveform.t[1] - waveform.t[0]):
            t, x = np.append(t[0] - 1e-6, t), np.vstack([np.full(x.shape[1], np.nan), x])
        for p, name in enumerate(self._probes):
            self._send(f"waveform/{name}", t, x[:, p])
            self._send(f"waveform/{name}/keyphasor", edges, np.interp(edges, waveform.t, waveform.x[:, p] * UM))
        self._shown_until = float(t[-1])

    def _send(self, path: str, t: NDArray[np.float64], values: NDArray[np.float64]) -> None:
        if len(t):
            self._stream.send_columns(
                path, indexes=[rr.TimeColumn("time", duration=t)], columns=rr.Scalars.columns(scalars=values)
            )


def _thinned(waveform: Waveform | None) -> Waveform | None:
    """Return about `PER_TURN` points of each turn."""
    if waveform is None:
        return None
    step = max(1, len(waveform.t) // (PER_TURN * (len(waveform.edges) - 1)))
    return dataclasses.replace(waveform, t=waveform.t[::step], x=waveform.x[::step])
