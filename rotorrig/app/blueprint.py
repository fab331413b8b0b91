"""Which view stands where in the Rerun viewer, for the live picture and for the result."""

from collections.abc import Sequence

import rerun as rr
import rerun.blueprint as rrb

from rotorrig.processing.probe_planes import planes
from rotorrig.rig.description import RigConfig

BACKGROUND = (20, 23, 27)
TIME_BASE = 0.25  # s of waveform: two turns at 480 rpm
ORBIT_BOUNDS = rrb.VisualBounds2D(x_range=(-18, 106), y_range=(-12, 116))
BODE_BOUNDS = rrb.VisualBounds2D(x_range=(-18, 194), y_range=(-11, 117))
MAP_BOUNDS = rrb.VisualBounds2D(x_range=(-30, 208), y_range=(-13, 78))


def live_blueprint(rig: RigConfig) -> rrb.Blueprint:
    """Return orbits left, Bode plots right, speed and time base below."""
    now, ever = rr.TimeRangeBoundary.cursor_relative(), rr.TimeRangeBoundary.infinite()
    recent = rr.TimeRangeBoundary.cursor_relative(seconds=-TIME_BASE)
    below = rrb.Horizontal(
        rrb.TimeSeriesView(
            origin="speed",
            name="Speed, rpm",
            axis_x=rrb.TimeAxis(view_range=rr.TimeRange(ever, ever)),
            time_ranges=[rrb.VisibleTimeRange("time", start=ever, end=now)],
            plot_legend=rrb.PlotLegend(visible=False),
        ),
        rrb.TimeSeriesView(
            origin="waveform",
            name="Time base, µm about the mean; dots at the keyphasor",
            axis_x=rrb.TimeAxis(view_range=rr.TimeRange(recent, now)),
            time_ranges=[rrb.VisibleTimeRange("time", start=recent, end=now)],
            plot_legend=rrb.PlotLegend(corner=rrb.Corner2D.LeftTop),
        ),
        column_shares=[1, 1.6],
    )
    above = rrb.Horizontal(*_orbits_and_bodes(rig, [p.name for p in rig.probes]), column_shares=[1, 2.3])
    return _blueprint(rrb.Vertical(above, below, row_shares=[3, 1]), timeline="time")


def result_blueprint(rig: RigConfig, probes: Sequence[str]) -> rrb.Blueprint:
    """Return orbits left, Bode plots in the middle, residual map and words below; the timeline is the speed."""
    below = rrb.Horizontal(
        rrb.TextDocumentView(origin="verdict", name="Verdict and identified values"),
        _flat("residual", "Residual in standard deviations of the noise, 1X", MAP_BOUNDS),
        column_shares=[1, 1.6],
    )
    above = rrb.Horizontal(*_orbits_and_bodes(rig, probes), column_shares=[1, 2.3])
    return _blueprint(rrb.Vertical(above, below, row_shares=[2.4, 1]), timeline="speed_rpm")


def _orbits_and_bodes(rig: RigConfig, probes: Sequence[str]) -> list[rrb.Container]:
    orbits = [_flat(f"orbit/{i}", f"Orbit: {plane.name}", ORBIT_BOUNDS) for i, plane in enumerate(planes(rig))]
    bodes = [_flat(f"bode/{name}", f"Bode, 1X: probe {name}", BODE_BOUNDS) for name in probes]
    grid = rrb.Grid(*bodes, grid_columns=1 if len(bodes) < 2 else 2)
    return [rrb.Vertical(*orbits), grid] if orbits else [grid]


def _flat(origin: str, name: str, bounds: rrb.VisualBounds2D) -> rrb.Spatial2DView:
    return rrb.Spatial2DView(origin=origin, name=name, background=BACKGROUND, visual_bounds=bounds)


def _blueprint(root: rrb.Container, *, timeline: str) -> rrb.Blueprint:
    return rrb.Blueprint(
        root,
        rrb.BlueprintPanel(state="hidden"),
        rrb.SelectionPanel(state="hidden"),
        rrb.TimePanel(state="collapsed", timeline=timeline),
        auto_views=False,
        auto_layout=False,
    )
