"""Layout of the result view in Rerun: tabs, from the verdict to the rotor."""

from collections.abc import Sequence

import numpy as np
import rerun.blueprint as rrb

from rotorrig.app.viewer.blueprint import BACKGROUND, BODE_BOUNDS, ORBIT_BOUNDS, POLAR_BOUNDS, flat, make_blueprint
from rotorrig.app.viewer.result.cascade import map_paths
from rotorrig.app.viewer.result.data import Result
from rotorrig.app.viewer.result.missing import PATH
from rotorrig.balancing import Balance
from rotorrig.identify.discovery import MissingForce
from rotorrig.processing import Plane

SPEED_BOUNDS = rrb.VisualBounds2D(x_range=(-18, 194), y_range=(-11, 110))
MAP_BOUNDS = rrb.VisualBounds2D(x_range=(-34, 206), y_range=(-13, 124))
PLAYED = 240.0  # rpm, or degrees of shaft angle, per second
PLACE_BOUNDS = rrb.VisualBounds2D(x_range=(-18, 194), y_range=(-11, 124))
SPECTRA_BOUNDS = rrb.VisualBounds2D(x_range=(-20, 196), y_range=(-20, 152))
CASCADE_BOUNDS = rrb.VisualBounds2D(x_range=(-18, 198), y_range=(-11, 117))


def result_layout(result: Result, modes: Sequence[str]) -> rrb.Blueprint:
    """Return the layout of a result; `modes` are the titles of the mode shapes drawn. The timeline is the speed."""
    planes, probes = [plane for plane, _ in result.planes], result.response.probes
    polars = [flat(f"polar/{name}", f"Polar 1X, probe {name}", POLAR_BOUNDS) for name in probes]
    tabs = [_overview(result, planes), _grid("Bode", [_bode(name) for name in probes]), _grid("Polar", polars)]
    if planes and 0.0 in result.response.orders:
        tabs.append(_centreline(planes))
    if planes or result.spectra:
        tabs.append(_spectrum(result, planes))
    if result.balance is not None:
        tabs.append(_balance(result.balance))
    if result.diagnosis is not None and result.diagnosis.missing is not None:
        tabs.append(_missing(result.diagnosis.missing))
    tabs.append(_rotor(modes, result.response.rig.shaft.length))
    return make_blueprint(rrb.Tabs(*tabs, active_tab=0), timeline="speed_rpm", fps=PLAYED)


def _overview(result: Result, planes: Sequence[Plane]) -> rrb.Container:
    words = rrb.Vertical(
        rrb.TextDocumentView(origin="verdict", name="Verdict and identified values"),
        rrb.TextDocumentView(origin="colours", name="Colours and conventions"),
        row_shares=[2.1, 1],
    )
    orbits = [flat(f"orbit/{i}", f"Orbit {', '.join(plane.probes)}", ORBIT_BOUNDS) for i, plane in enumerate(planes)]
    above = rrb.Horizontal(*orbits, _bode(_telling_probe(result)), column_shares=[*[1] * len(orbits), 1.7])
    pictures = [above]
    if result.diagnosis is not None:
        pictures.append(rrb.Horizontal(*_maps(result)))
    right = rrb.Vertical(*pictures, row_shares=[1.35, 1][: len(pictures)])
    return rrb.Horizontal(words, right, column_shares=[1, 2.4], name="Overview")


def _telling_probe(result: Result) -> str:
    """Return the probe where the model was furthest off, or the first."""
    worst = [misfit.probe for misfit in result.diagnosis.worst] if result.diagnosis else []
    return next((probe for probe in worst if probe in result.response.probes), result.response.probes[0])


def _maps(result: Result) -> list[rrb.View]:
    what = "Residual 1X, sigmas of the noise"
    if result.extended is None:
        return [flat("residual/before", what, MAP_BOUNDS)]
    return [
        flat("residual/before", f"{what}: before the extension", MAP_BOUNDS),
        flat("residual/after", f"{what}: after it", MAP_BOUNDS),
    ]


def _bode(probe: str) -> rrb.View:
    return flat(f"bode/{probe}", f"Bode 1X, probe {probe}", BODE_BOUNDS)


def _centreline(planes: Sequence[Plane]) -> rrb.Container:
    paths = [flat(f"centreline/{i}", f"Shaft centreline: {plane.name}", ORBIT_BOUNDS) for i, plane in enumerate(planes)]
    gap = flat("gap", "Gap: mean position towards each probe", SPEED_BOUNDS)
    return rrb.Vertical(rrb.Horizontal(*paths), gap, row_shares=[1.4, 1], name="Centreline")


def _spectrum(result: Result, planes: Sequence[Plane]) -> rrb.Container:
    """Return a row per place: its cascades, by frequency of a recording, else by order; and its whirl, if a plane."""
    rows: dict[str, list[rrb.View]] = {}
    for path, one in zip(map_paths(result.spectra), result.spectra, strict=True):
        rows.setdefault(one.place, []).append(flat(path, f"Cascade {one.run}: {one.place}", SPECTRA_BOUNDS))
    for i, plane in enumerate(planes):
        row = rows.setdefault(plane.name, [])
        if not row:
            row.append(flat(f"cascade/{i}", f"Full spectrum over speed: {plane.name}", CASCADE_BOUNDS))
        row.append(flat(f"whirl/{i}", f"Forward and backward whirl: {plane.name}", SPEED_BOUNDS))
    return rrb.Vertical(*(rrb.Horizontal(*row) for row in rows.values()), name="Spectrum")


def _balance(balance: Balance) -> rrb.Container:
    names = [balance.prediction.probes[p] for p in np.unique(balance.prediction.probe)]
    polars = [flat(f"balance/{name}", f"Before and as predicted after, probe {name}", POLAR_BOUNDS) for name in names]
    words = rrb.TextDocumentView(origin="correction", name="Correction")
    pictures = rrb.Grid(*polars, grid_columns=1 if len(polars) < 2 else 2)
    return rrb.Horizontal(words, pictures, column_shares=[1, 2], name="Balance")


def _missing(missing: MissingForce) -> rrb.Container:
    words = rrb.TextDocumentView(origin=f"{PATH}/words", name="What is missing")
    pictures: list[rrb.View | rrb.Container] = []
    if missing.places.size:
        pictures.append(flat(f"{PATH}/place", "Its place along the shaft", PLACE_BOUNDS))
    if missing.over_speed is not None:
        force = flat(f"{PATH}/force", "The missing force over speed", SPEED_BOUNDS)
        motion = flat(f"{PATH}/motion", "The missing force over the motion of its place", SPEED_BOUNDS)
        pictures.append(rrb.Horizontal(force, motion))
    if not pictures:
        return rrb.Vertical(words, name="Missing force")
    return rrb.Horizontal(words, rrb.Vertical(*pictures), column_shares=[1, 2.4], name="Missing force")


def _rotor(modes: Sequence[str], length: float) -> rrb.Container:
    shapes = [_solid(f"mode/{i}", f"{title}; size arbitrary", length=length, away=0.8) for i, title in enumerate(modes)]
    deflection = _solid("deflection", "1X deflection at the cursor's speed", length=length, away=0.72)
    if not shapes:
        return rrb.Vertical(deflection, name="Rotor")
    return rrb.Vertical(deflection, rrb.Horizontal(*shapes), row_shares=[1.3, 1], name="Rotor")


def _solid(origin: str, name: str, *, length: float, away: float) -> rrb.Spatial3DView:
    """Return a view of a rotor `length` [m] long from its side, `away` lengths from its middle."""
    middle, offset = (0.48 * length, 0.0, 0.03 * length), (-0.3, -0.92, 0.26)
    place = [m + away * length * o for m, o in zip(middle, offset, strict=True)]
    eye = rrb.EyeControls3D(position=place, look_target=middle, eye_up=(0, 0, 1))
    return rrb.Spatial3DView(origin=origin, name=name, background=BACKGROUND, line_grid=False, eye_controls=eye)


def _grid(name: str, views: Sequence[rrb.View]) -> rrb.Container:
    return rrb.Grid(*views, grid_columns=1 if len(views) < 2 else 2, name=name)
