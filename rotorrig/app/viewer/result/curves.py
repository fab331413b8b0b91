"""Static plots of a result: Bode and polar plots, residual maps, centrelines, gaps, whirl over speed."""

from collections.abc import Iterator

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from rotorrig.app.plot_data import (
    REFERENCE,
    SMALLEST_PATH,
    CentrelinePath,
    CriticalSpeed,
    centreline_paths,
    clearance_circle,
    phase_window,
    residual_grid,
)
from rotorrig.app.text import resonance_text
from rotorrig.app.viewer.plots import (
    BACKWARD,
    DOWN,
    FORWARD,
    MODEL_DOWN,
    MODEL_UP,
    PROBE_COLOURS,
    UP,
    BodePicture,
    CentrelinePicture,
    Panels,
    PolarPicture,
    ResidualPicture,
    SpeedPicture,
    below_one_another,
    legend,
    pale,
    speed_marks,
)
from rotorrig.app.viewer.result.data import Result
from rotorrig.processing.tracking import whirl_vectors
from rotorrig.rig.config import RPM, UM

BEFORE = (176, 132, 214)  # the model that was extended
MAP_BINS = 100  # of the residual map: about four rows of a run in each
FLATTEST = 1e-6  # m: an axis spans no less
LABELS_APART = 0.2  # of the largest excursion of a centreline: nearer speeds are not named
Colour = tuple[int, int, int]
CentrelineTrack = tuple[CentrelinePicture, CentrelinePath | None]


def draw_bodes(stream: rr.RecordingStream, result: Result) -> list[Panels]:
    """Draw a Bode plot for every probe and return its axes."""
    return [_draw_bode(stream, result, p) for p in range(len(result.response.probes))]


def _draw_bode(stream: rr.RecordingStream, result: Result, p: int) -> Panels:
    name, z = result.response.probes[p], result.z[:, p]
    title = f"{name}: 1X amplitude, {result.word}, {result.unit.name}"
    picture = BodePicture(stream, f"bode/{name}", title=title, fastest=result.fastest, static=True, unit=result.unit)
    largest = float(np.nanmax(np.abs(z), initial=0.0))
    panels = picture.panels(largest, result.fastest, lag_from=phase_window(z))
    for i in result.sweeps:
        rows, up = result.response.run == i, result.response.runs[i].direction > 0
        rpm = result.rpm[rows]
        dots, radius, order = (UP, 2.4, 1.0) if up else (DOWN, 1.2, 2.0)  # smaller on top: both show where they agree
        picture.dots(f"{i}-measured", panels, rpm, z[rows], dots, radius=radius, order=order)
        if result.extended is not None and result.base is not None:
            picture.line(f"{i}-before", panels, rpm, result.base[rows, p], BEFORE, order=1.0 + order)
        if result.model is not None:
            colour = MODEL_UP if up else MODEL_DOWN
            picture.line(f"{i}-model", panels, rpm, result.model[rows, p], colour, order=3.0 + order)
    _draw_runs(stream, result, f"bode/{name}", 172.0, 6.0)
    marks = [mark for each in result.critical_speeds if each.probe == name for mark in _critical_marks(each)]
    picture.mark_speeds("critical", panels, marks)
    return panels


def _critical_marks(critical: CriticalSpeed) -> Iterator[tuple[float, str, Colour]]:
    """Yield speed [rpm], words and colour of a critical speed, then those of the model's."""
    colours = (UP, MODEL_UP) if critical.direction > 0 else (DOWN, MODEL_DOWN)
    whose = (critical.run, f"{critical.run}, model")
    for found, words, colour in zip((critical.measured, critical.model), whose, colours, strict=True):
        if found is not None:
            yield found.omega.value * RPM, f"{words}: {resonance_text(found)}", colour


def _draw_runs(stream: rr.RecordingStream, result: Result, path: str, x: float, y: float) -> None:
    """Write the name of each run in its colour, from x, y of the view down."""
    runs = [result.response.runs[i] for i in result.sweeps]
    words = [(run.name, UP if run.direction > 0 else DOWN) for run in runs]
    stream.log(f"{path}/runs", legend(words, below_one_another(x, y)), static=True)


def draw_polars(stream: rr.RecordingStream, result: Result) -> list[PolarPicture]:
    """Draw a polar plot for every probe and return them, so that the cursor's vector may be added."""
    return [_draw_polar(stream, result, p) for p in range(len(result.response.probes))]


def _draw_polar(stream: rr.RecordingStream, result: Result, p: int) -> PolarPicture:
    response, name = result.response, result.response.probes[p]
    title = f"{name}: 1X, {result.word}, {result.unit.name} and ° of phase lag"
    angle = response.rig.probe(name).angle
    picture = PolarPicture(
        stream,
        f"polar/{name}",
        title=title,
        probe_angle=angle,
        rotation=response.rig.rotation,
        static=True,
        unit=result.unit,
    )
    models: list[tuple[str, NDArray[np.complex128], Colour]] = []
    measured = []
    for i in result.sweeps:
        rows, up = response.run == i, response.runs[i].direction > 0
        if result.extended is not None and result.base is not None:
            models.append((f"{i}-before", result.base[rows, p], BEFORE))
        if result.model is not None:
            models.append((f"{i}-model", result.model[rows, p], MODEL_UP if up else MODEL_DOWN))
        measured.append((f"{i}-measured", result.z[rows, p], UP if up else DOWN))
    named = {f"{i}-measured": result.rpm[response.run == i] for i in result.sweeps[:1]}
    picture.draw([*measured, *models], rpm=named)
    _draw_runs(stream, result, f"polar/{name}", -8.0, -8.0)
    return picture


def draw_residuals(stream: rr.RecordingStream, result: Result) -> None:
    """Draw the 1X residual in sigmas, of the base model and of the extended one, where there is a diagnosis."""
    diagnosis, response = result.diagnosis, result.response
    if diagnosis is None:
        return
    for name, sigmas in (("before", diagnosis.sigmas), ("after", diagnosis.extended_sigmas)):
        if sigmas is not None:
            ResidualPicture(stream, f"residual/{name}").draw(*residual_grid(response, sigmas, bins=MAP_BINS))


def draw_centrelines(stream: rr.RecordingStream, result: Result) -> list[CentrelineTrack]:
    """Draw where the mean position goes in every plane; return the pictures and the paths a cursor may go along."""
    paths = centreline_paths(result.response)
    return [_draw_centreline(stream, result, i, paths) for i in range(len(result.planes))] if paths else []


def _draw_centreline(
    stream: rr.RecordingStream, result: Result, i: int, paths: tuple[CentrelinePath, ...]
) -> CentrelineTrack:
    plane, rig = result.planes[i][0], result.response.rig
    circle = clearance_circle(rig, plane.position)
    by = result.unit.by_length / UM
    picture = CentrelinePicture(
        stream,
        f"centreline/{i}",
        clearance=None if circle is None else 2 * circle.radius * by,
        gravity=rig.gravity,
        static=True,
        unit=result.unit,
    )
    mine = tuple(path for path in paths if path.plane == plane.name)
    drawn = [
        (f"{k}", by * np.column_stack([path.x, path.y]), UP if path.direction > 0 else DOWN)
        for k, path in enumerate(mine)
    ]
    labels = [(by * x, by * y, words) for x, y, words in _speeds_along(mine[0])] if mine else []
    picture.draw(drawn, labels=labels)
    _draw_runs(stream, result, f"centreline/{i}", 10.0, 6.0)
    return picture, mine[0] if mine else None


def _speeds_along(path: CentrelinePath) -> list[tuple[float, float, str]]:
    """Return places [µm] along a centreline and the speeds there; none where it goes nowhere."""
    xy = path.x + 1j * path.y
    reach = float(np.abs(xy).max())
    apart = LABELS_APART * max(reach, SMALLEST_PATH)
    if reach < apart:
        return []
    return [(float(path.x[k]), float(path.y[k]), f"{path.rpm[k]:.0f}") for k in speed_marks(path.rpm, xy, apart=apart)]


def draw_gaps(stream: rr.RecordingStream, result: Result) -> None:
    """Draw the gap of every probe over speed, from where it is at the slowest."""
    response = result.response
    if 0.0 not in response.orders:
        return
    gap = np.where(response.usable, response.order(0.0).real, np.nan) * result.unit.by_length
    lines, names, unit = [], [], result.unit.length
    for p, name in enumerate(response.probes):
        colour = PROBE_COLOURS[p % len(PROBE_COLOURS)]
        start = _where_slowest(result, gap[:, p])
        names.append((f"{name} ({start:.4g} {unit})", colour))
        for i in result.sweeps:
            rows = response.run == i
            shade = colour if response.runs[i].direction > 0 else pale(colour)
            lines.append((f"{name}/{i}", result.rpm[rows], gap[rows, p] - start, shade))
    title = f"towards the probe, {unit} from where it is slowest (in brackets: from the gap voltage); pale: speed falls"
    flattest = FLATTEST * result.unit.by_length
    SpeedPicture(stream, "gap", title=title, fastest=result.fastest, flattest=flattest).draw(lines, names=names)


def _where_slowest(result: Result, gap: NDArray[np.float64]) -> float:
    """Return the mean of `gap` (row,) over the slowest usable rows of the first sweep; 0 where there are none."""
    if not result.sweeps:
        return 0.0
    rows = np.flatnonzero((result.response.run == result.sweeps[0]) & np.isfinite(gap))
    slowest = rows[np.argsort(result.rpm[rows])[:REFERENCE]]
    return float(gap[slowest].mean()) if len(slowest) else 0.0


def draw_whirl(stream: rr.RecordingStream, result: Result) -> None:
    """Draw the forward and backward part of 1X over speed in every plane."""
    for i, seen in enumerate(whirl_vectors(result.response, compensated=result.compensated)):
        lines, names = [], []
        for run in result.sweeps:
            rows, of = result.response.run == run, result.response.runs[run]
            for way, z, colour in (("+1X", seen.forward, FORWARD), ("-1X", seen.backward, BACKWARD)):
                size = np.where(seen.usable, np.abs(z), np.nan)[rows] * result.unit.by
                shade = colour if of.direction > 0 else pale(colour)
                lines.append((f"{way}/{run}", result.rpm[rows], size, shade))
                names.append((f"{way} {of.name}", shade))
        title, flattest = f"+1X and -1X, {result.word}, {result.unit.name}", FLATTEST * result.unit.by
        picture = SpeedPicture(stream, f"whirl/{i}", title=title, fastest=result.fastest, flattest=flattest)
        picture.draw(lines, names=names)
