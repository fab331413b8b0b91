"""Live view of a sweep in a Rerun stream; costlier parts are redrawn less often."""

from collections.abc import Iterable

import rerun as rr

from rotorrig.acquisition import Event
from rotorrig.app.text import AS_STATED, AmplitudeUnit
from rotorrig.app.viewer.live.data import WAYS, History, LiveTracker
from rotorrig.app.viewer.live.parts.cascade import CascadesPart
from rotorrig.app.viewer.live.parts.orbits import TURNS, OrbitsPart, first_order
from rotorrig.app.viewer.live.parts.position import CentrelinesPart, GapsPart
from rotorrig.app.viewer.live.parts.readings import readings
from rotorrig.app.viewer.live.parts.vectors import VectorsPart
from rotorrig.app.viewer.plots import MARK, UP, displayable
from rotorrig.processing.rows import ENDS
from rotorrig.rig.config import RPM, RigConfig
from rotorrig.rig.probes import Block, DaqInfo

CURVES_EVERY = 1.0  # s of the sample clock: whole curves are sent each time
READINGS_EVERY = 0.5  # s
LEVELS = {"trip": "ERROR", "emergency": "ERROR", "abort": "WARN", "gap": "WARN", "overrun": "WARN"}  # of events


class LiveScene:
    """Takes every block, draws when asked to.

    `whole`, the history of a recording that is known beforehand, is drawn once and for all; else curves grow with the
    blocks. `events` are shown when their time has come, amplitudes are told in `unit`.
    """

    def __init__(
        self,
        rig: RigConfig,
        info: DaqInfo,
        stream: rr.RecordingStream,
        *,
        events: Iterable[Event] = (),
        whole: History | None = None,
        unit: AmplitudeUnit = AS_STATED,
    ) -> None:
        self._stream = stream
        self._rig = rig
        self._unit = unit
        self._tracker = LiveTracker(rig, info)
        self._whole = whole
        self._history = whole or History(rig)
        self._events = sorted(events, key=lambda event: event.t_ns)
        self._note = ""  # the last mark's text
        static = whole is not None
        self._orbits = OrbitsPart(stream, rig, unit=unit)
        self._vectors = VectorsPart(stream, rig, static=static, unit=unit)
        self._centrelines = CentrelinesPart(stream, rig, static=static, unit=unit)
        self._gaps = GapsPart(stream, rig)
        self._cascades = CascadesPart(stream, rig, static=static, unit=unit)
        self._curves_due = self._readings_due = 0.0
        self._style_speed()
        if static:
            self._draw_curves()

    def take(self, block: Block) -> None:
        """Track the next block."""
        turns = self._tracker.take(block)
        if self._whole is None:
            self._history.add(turns, self._tracker.waveform())

    def draw(self, *, last: bool = False) -> None:
        """Draw the present state at the present time of the sample clock; the `last` picture leaves nothing out."""
        self._draw_events()
        time, waveform = self._tracker.time, self._tracker.waveform()
        self._stream.set_time("time", duration=time)
        self._stream.log("speed/keyphasor", rr.Scalars(self._tracker.speed * RPM))
        if self._whole is None and (last or time >= self._curves_due):
            self._draw_curves()
            self._curves_due = time + CURVES_EVERY
        slow_roll = self._history.slow_roll
        shown = None if waveform is None else waveform.last(TURNS)
        if shown is not None:
            self._orbits.draw(shown, slow_roll)
            self._vectors.now(shown.omega * RPM, first_order(shown), slow_roll)
        gap = waveform.gap if waveform is not None else self._tracker.gap
        if last or time >= self._readings_due:
            self._centrelines.now(gap)
            self._gaps.draw(gap)
            words = readings(self._rig, shown, self._gaps.volts(gap), slow_roll, unit=self._unit, note=self._note)
            self._stream.log("readings", rr.TextDocument(words, media_type=rr.MediaType.MARKDOWN))
            self._readings_due = time + READINGS_EVERY

    def _draw_curves(self) -> None:
        curves = self._history.curves
        if any(curves.count(way) for way in WAYS):
            self._vectors.draw(curves, self._history.slow_roll)
            self._centrelines.draw(curves)
        self._cascades.draw(self._history.spectra)

    def _draw_events(self) -> None:
        """Show the events up to now, as words and as marks on the curve of the speed."""
        while self._events and self._events[0].t_ns / 1e9 <= self._tracker.time:
            event = self._events.pop(0)
            seconds = event.t_ns / 1e9
            self._stream.set_time("time", duration=seconds)
            words = f"{event.kind}: {event.text}" if event.text else event.kind
            entry = displayable(f"{seconds:.1f} s, {words}")
            self._stream.log("events", rr.TextLog(entry, level=LEVELS.get(event.kind, "INFO")))
            self._stream.log("speed/events", rr.Scalars(self._tracker.speed * RPM))
            if event.kind in ("mark", *ENDS):
                self._note = event.text if event.kind == "mark" else words

    def _style_speed(self) -> None:
        self._stream.log("speed/keyphasor", rr.SeriesLines(colors=UP, widths=1.5, names="speed, rpm"), static=True)
        marks = rr.SeriesPoints(colors=MARK, markers="diamond", marker_sizes=4.0, names="events")
        self._stream.log("speed/events", marks, static=True)
