"""Layout of the live and the replay view: tabs, the first for the operator of the sweep."""

import math

import rerun as rr
import rerun.blueprint as rrb
from rerun.blueprint.archetypes import TextLogColumns
from rerun.blueprint.encodings import TextLogColumnKind

from rotorrig.app.viewer.blueprint import BACKGROUND, POLAR_BOUNDS, flat, make_blueprint
from rotorrig.processing import planes
from rotorrig.rig.config import RigConfig

TABS = ("Sweep", "Orbits", "Polar", "Position", "Spectra")
ORBIT_BOUNDS = rrb.VisualBounds2D(x_range=(-20, 112), y_range=(-11, 127))
BODE_BOUNDS = rrb.VisualBounds2D(x_range=(-18, 194), y_range=(-11, 120))
TIME_BASE_BOUNDS = rrb.VisualBounds2D(x_range=(-18, 156), y_range=(-12, 130))
CENTRELINE_BOUNDS = rrb.VisualBounds2D(x_range=(-20, 112), y_range=(-12, 118))
CASCADE_BOUNDS = rrb.VisualBounds2D(x_range=(-18, 198), y_range=(-11, 117))
OVERLAID = ("unfiltered", "1X", "compensated-1X", "caption")
APART = (
    (("unfiltered",), "all orders"),
    (("1X", "compensated-1X"), "1X, green less slow roll"),
    (("compensated",), "all orders, less slow roll"),
)


def live_blueprint(rig: RigConfig, *, tab: str = "Sweep") -> rrb.Blueprint:
    """Return the layout of a sweep that runs, opened at one of TABS."""
    return _tabs(rig, events=False, tab=tab)


def replay_blueprint(rig: RigConfig) -> rrb.Blueprint:
    """Return the layout of a recording: that of a sweep, with its events."""
    return _tabs(rig, events=True, tab="Sweep")


def _tabs(rig: RigConfig, *, events: bool, tab: str) -> rrb.Blueprint:
    pages = [_sweep(rig, events=events), _orbits(rig), _polar(rig), _position(rig), _spectra(rig)]
    there = [page for page in pages if page is not None]
    active = [page.name for page in there].index(tab)
    return make_blueprint(rrb.Tabs(*there, active_tab=active), timeline="time")


def _sweep(rig: RigConfig, *, events: bool) -> rrb.Container:
    """Return orbits left, Bode plots right, speed and readings below."""
    orbits = [_orbit(i, OVERLAID, f"Orbit: {plane.name}") for i, plane in enumerate(planes(rig))]
    bodes = [flat(f"bode/{probe.name}", f"Bode, 1X: probe {probe.name}", BODE_BOUNDS) for probe in rig.probes]
    grid = _square(bodes)
    above = rrb.Horizontal(_square(orbits, tall=True), grid, column_shares=[1, 2.3]) if orbits else grid
    below = [_over_time("speed", "Speed, rpm"), rrb.TextDocumentView(origin="readings", name="Readings")]
    if events:
        words = TextLogColumns(text_log_columns=[TextLogColumnKind.Body])  # which say the time
        below.append(rrb.TextLogView(origin="events", name="Events", columns=words))
    shares = [1.0, 1.25, 1.0][: len(below)]
    return rrb.Vertical(above, rrb.Horizontal(*below, column_shares=shares), row_shares=[2.7, 1], name=TABS[0])


def _orbits(rig: RigConfig) -> rrb.Container | None:
    """Return, per plane, the orbit unfiltered, of 1X alone, and less the slow roll, beside its time base."""
    rows = []
    for i, plane in enumerate(planes(rig)):
        where = ", ".join(plane.probes)
        views = [_orbit(i, parts, f"{where}: {name}") for parts, name in APART]
        views.append(flat(f"time-base/{i}", f"Time base {where}, all orders", TIME_BASE_BOUNDS))
        rows.append(rrb.Horizontal(*views, column_shares=[1, 1, 1, 1.25]))
    return rrb.Vertical(*rows, name=TABS[1]) if rows else None


def _polar(rig: RigConfig) -> rrb.Container:
    views = [flat(f"polar/{probe.name}", f"Polar, 1X: probe {probe.name}", POLAR_BOUNDS) for probe in rig.probes]
    return _square(views, name=TABS[2])


def _position(rig: RigConfig) -> rrb.Container:
    """Return the shaft centrelines above the gap voltages."""
    paths = [
        flat(f"centreline/{i}", f"Shaft centreline: {plane.name}", CENTRELINE_BOUNDS)
        for i, plane in enumerate(planes(rig))
    ]
    gaps = _over_time("gap", "Gap voltage, V, and the ends of the linear range", legend=True)
    if not paths:
        return rrb.Vertical(gaps, name=TABS[3])
    return rrb.Vertical(rrb.Horizontal(*paths), gaps, row_shares=[1.6, 1], name=TABS[3])


def _spectra(rig: RigConfig) -> rrb.Container | None:
    """Return, per plane, the cascades of rising and of falling speed."""
    views = [
        flat(f"cascade/{i}/{way}", f"Cascade {', '.join(plane.probes)}: speed going {way}", CASCADE_BOUNDS)
        for i, plane in enumerate(planes(rig))
        for way in ("up", "down")
    ]
    return rrb.Grid(*views, grid_columns=2, name=TABS[4]) if views else None


def _square(views: list[rrb.Spatial2DView], *, tall: bool = False, name: str | None = None) -> rrb.Grid:
    """Return views in about as many rows as columns; with fewer columns if it is to be `tall`."""
    columns = math.ceil(math.sqrt(len(views) / (2 if tall else 1)))
    return rrb.Grid(*views, grid_columns=columns, name=name)


def _orbit(plane: int, parts: tuple[str, ...], name: str) -> rrb.Spatial2DView:
    """Return a view of some of a plane's orbits, which all are drawn to one scale."""
    origin = f"orbit/{plane}"
    contents = [f"+ {origin}/{part}/**" for part in ("axes", *parts)]
    return rrb.Spatial2DView(
        origin=origin, contents=contents, name=name, background=BACKGROUND, visual_bounds=ORBIT_BOUNDS
    )


def _over_time(origin: str, name: str, *, legend: bool = False) -> rrb.TimeSeriesView:
    """Return a plot over the whole time up to now."""
    now, ever = rr.TimeRangeBoundary.cursor_relative(), rr.TimeRangeBoundary.infinite()
    return rrb.TimeSeriesView(
        origin=origin,
        name=name,
        axis_x=rrb.TimeAxis(view_range=rr.TimeRange(ever, ever)),
        time_ranges=[rrb.VisibleTimeRange("time", start=ever, end=now)],
        plot_legend=rrb.PlotLegend(corner=rrb.Corner2D.LeftBottom, visible=legend),
    )
