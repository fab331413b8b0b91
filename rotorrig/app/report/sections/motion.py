"""Orbits at a few speeds, shaft centreline and gap voltages."""

from html import escape

import numpy as np

from rotorrig.app.plot_data import (
    REFERENCE,
    CentrelinePath,
    ClearanceCircle,
    centreline_paths,
    centreline_words,
    clearance_circle,
    half_width,
    is_seen_in,
)
from rotorrig.app.report.drawings import orbit_pictures
from rotorrig.app.report.figures import centreline
from rotorrig.app.report.html import Section, paragraph, plot, section, table
from rotorrig.app.report.sections.synchronous import compensation
from rotorrig.processing import OrderTrackedResponse
from rotorrig.rig.config import UM, micrometres


def orbits_section(response: OrderTrackedResponse) -> Section | None:
    """Return the 1X orbits at a few speeds of the first sweep; None without a plane of two probes or phases."""
    if response.amplitudes_alone:
        return None
    lines = [
        f'<h3>{escape(plane.name)}</h3><div class="orbits">{"".join(pictures)}</div>'
        for plane, pictures in orbit_pictures(response)
        if pictures
    ]
    if not lines:
        return None
    note = paragraph(compensation(response), "The dot is the keyphasor edge, the arrow the direction of whirl.")
    return section("orbits", "Orbits at 1X", note, *lines)


def centreline_section(response: OrderTrackedResponse) -> Section | None:
    """Return the shaft centreline of each plane and the gap voltages; None if the gap was not tracked."""
    gaps = _gaps(response)
    if not gaps:
        return None
    paths = centreline_paths(response)
    plots, rows = [], []
    planes = _by_plane(paths)
    circles = {plane: clearance_circle(response.rig, mine[0].position) for plane, mine in planes.items()}
    reach = max((half_width(mine, circles[plane]) for plane, mine in planes.items()), default=0.0)
    for i, (plane, mine) in enumerate(planes.items()):
        circle = circles[plane]
        scale = f"{plane}: axes ±{reach:g} µm, {_clearance(mine, circle)}"
        plots.append(
            plot(
                f"mean-position-{i}",
                centreline(mine, circle, reach=reach),
                caption=scale,
                label=f"Mean position of the shaft at {scale}. {centreline_words(tuple(mine))}",
                share=0.5,
            )
        )
        rows += [_path_row(path, circle) for path in mine]
    header = ["plane, run", "moves up to", "from rpm", "to rpm", "share of radial bearing clearance"]
    clear = any(row[-1] for row in rows)  # a column of nothing is left out
    moves = table("Mean position", header if clear else header[:-1], [row if clear else row[:-1] for row in rows])
    note = paragraph(_NOTE, _CIRCLE if clear else "")
    shown = [note, f'<div class="pair">{"".join(plots)}</div>', moves] if paths else []
    return section("centreline", "Shaft centreline and gap", *shown, gaps)


def _by_plane(paths: tuple[CentrelinePath, ...]) -> dict[str, list[CentrelinePath]]:
    planes: dict[str, list[CentrelinePath]] = {}
    for path in paths:
        planes.setdefault(path.plane, []).append(path)
    return planes


def _clearance(paths: list[CentrelinePath], circle: ClearanceCircle | None) -> str:
    """Say what the clearance is, and why no circle shows it."""
    if circle is None:
        return "no bearing clearance in the config"
    words = f"clearance of {circle.bearing}: radius {micrometres(circle.radius / UM)} µm"
    return words if is_seen_in(paths, circle) else f"{words}, far outside"


def _path_row(path: CentrelinePath, circle: ClearanceCircle | None) -> list[str]:
    cells = [f"{micrometres(path.reach)} µm", f"{path.rpm.min():.0f}", f"{path.rpm.max():.0f}"]
    of_it = f"{path.reach * UM / circle.radius:.1%} ({circle.bearing})" if circle else ""
    return [f"{path.plane}, {path.run}", *cells, of_it]


def _gaps(response: OrderTrackedResponse) -> str:
    """Return each probe's gap voltage at the slowest and fastest rows; nothing if the gap was not tracked."""
    if 0.0 not in response.orders:
        return ""
    gap, order = response.order(0.0).real, np.argsort(response.omega)
    rows = []
    for p, name in enumerate(response.probes):
        usable = order[response.usable[order, p] & np.isfinite(gap[order, p])]
        probe = next(probe for probe in response.rig.probes if probe.name == name)
        if usable.size:
            ends = [float(gap[some, p].mean()) for some in (usable[:REFERENCE], usable[-REFERENCE:])]
            volts = [f"{probe.gap_voltage + probe.sensitivity * x:.3f}" for x in ends]
            linear = "{:g} to {:g}".format(*probe.linear_range)
            rows.append([name, *volts, f"{(ends[1] - ends[0]) * UM:+.2f}", linear])
    header = ["probe", "V, slowest rows", "V, fastest rows", "moves, µm (+ towards the probe)", "linear range, V"]
    return table(f"Gap voltage, mean of {REFERENCE} rows", header, rows) if rows else ""


_CIRCLE = (
    "The circle is the clearance of the nearest bearing, with the shaft at its bottom at the lowest speed; where the "
    "path would be a dot in it the axes are about the path. All planes have one scale."
)
_NOTE = (
    "Mean shaft position relative to the slowest rows. A linear rotor vibrates about one position at every "
    "speed. A mean position that follows the speed means a one-sided support or a stiffness that turns with the shaft; "
    "one that drifts with time means a probe warming up. Part of it may be cross-axis error: a round shaft recedes "
    "from a probe as it moves sideways."
)
