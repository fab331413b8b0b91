"""Time base and orbit of some turns as SVG pictures: raw orbit, orbit at 1X, and both probes over time.

One scale for the three. Drawing units are tenths of those of the other drawings, so that a path is whole numbers.
"""

from html import escape

import numpy as np
from numpy.typing import NDArray

from rotorrig.app.plot_data import TimeBase, nice, thin_indices

SIDE, FILL = 1000.0, 0.84  # half an orbit's picture, and the share of it that the scale takes
WIDE, TALL, LEFT, RIGHT, BELOW = 5000.0, 2000.0, 520.0, 200.0, 330.0  # the time base, and its margins
FRAME = 0.94  # of a probe's share of the height that the scale takes
LETTERS = 120.0  # height
POINTS = 220  # of a raw line
SMOOTH = 24  # points per turn of a line at 1X
Reals = NDArray[np.float64]


def time_base_picture(base: TimeBase) -> str:
    """Return a `<figure>` with the three pictures of some turns and their caption."""
    turns = len(base.edges) - 1
    scale = nice(max(float(np.abs(xy).max()) for xy in (base.raw, base.orbit)))
    at = f"{base.rpm:.0f} rpm, {base.speed}"
    one = slice(None, max(2, int(np.searchsorted(base.t, base.edges[1])) + 1))
    step = slice(None, None, max(1, len(base.t) // POINTS))
    raw = _orbit(base.orbit[step], _at_edges(base, base.orbit), scale, "raw", f"Raw orbit of {turns} turns at {at}")
    filtered = base.filtered_orbit[one]
    filtered = filtered[:: max(1, len(filtered) // (2 * SMOOTH))]
    closed = np.vstack([filtered, filtered[:1]])
    alone = _orbit(closed, base.filtered_orbit[:1], scale, "path", f"Orbit at 1X at {at}")
    return (
        f'<figure class="turns"><div class="orbit">{raw}<p>raw, {turns} turns</p></div>'
        f'<div class="orbit">{alone}<p>1X</p></div>{_time_base(base, scale, at)}'
        f"<figcaption><strong>{escape(at)}</strong>: frames ±{scale:g} µm; what is not 1X, {base.beside:.2g} µm rms"
        "</figcaption></figure>"
    )


def _orbit(xy: Reals, dots: Reals, scale: float, kind: str, words: str) -> str:
    """Return an orbit (point, 2) [µm] with its keyphasor dots (dot, 2)."""
    per_um, frame = SIDE * FILL / scale * np.array([1, -1]), SIDE * FILL  # the SVG's y points down
    label = f"{words}, within {np.abs(xy).max():.3g} µm"
    return (
        f'<svg viewBox="{-SIDE:g} {-SIDE:g} {2 * SIDE:g} {2 * SIDE:g}" role="img" aria-label="{escape(label)}">'
        f'<line class="axis" x1="{-SIDE:g}" x2="{SIDE:g}"/><line class="axis" y1="{-SIDE:g}" y2="{SIDE:g}"/>'
        f'<rect class="frame" x="{-frame:g}" y="{-frame:g}" width="{2 * frame:g}" height="{2 * frame:g}"/>'
        f"{_line(xy * per_um, kind)}{_dots(dots * per_um)}</svg>"
    )


def _time_base(base: TimeBase, scale: float, at: str) -> str:
    """Return both probes over time, raw and at 1X, with a line and a dot at every keyphasor edge."""
    per_ms = (WIDE - LEFT - RIGHT) / base.edges[-1]
    half = (TALL - BELOW) / 4
    parts = [_edges(base, per_ms)]
    turn = np.arange(0, len(base.t), max(1, len(base.t) // (SMOOTH * (len(base.edges) - 1))))
    dots = _at_edges(base, base.raw)
    for i, probe in enumerate(base.plane.probes):
        middle, per_um = half * (2 * i + 1), -FRAME * half / scale  # the SVG's y points down
        parts.append(_frame(middle, FRAME * half))
        parts.append(_text(LEFT - 60, middle + LETTERS / 3, probe, "end"))
        some = thin_indices(base.raw[:, i], most=POINTS)
        for rows, values, kind in ((some, base.raw, "raw"), (turn, base.filtered, "path")):
            places = np.column_stack([LEFT + base.t[rows] * per_ms, middle + values[rows, i] * per_um])
            parts.append(_line(places, kind))
        parts.append(_dots(np.column_stack([LEFT + base.edges * per_ms, middle + dots[:, i] * per_um])))
    largest = ", ".join(f"{p} {v:.3g}" for p, v in zip(base.plane.probes, np.abs(base.raw).max(axis=0), strict=True))
    words = f"Time base of {len(base.edges) - 1} turns at {at}: raw and at 1X; largest raw excursion in µm: {largest}"
    head = f'<svg class="time" viewBox="0 0 {WIDE:g} {TALL:g}" role="img" aria-label="{escape(words)}">'
    return f"{head}{''.join(parts)}</svg>"


def _frame(middle: float, half: float) -> str:
    """Return a frame of a probe's scale with its zero."""
    wide = WIDE - LEFT - RIGHT
    return (
        f'<rect class="frame" x="{LEFT:g}" y="{middle - half:.0f}" width="{wide:g}" height="{2 * half:.0f}"/>'
        f'<line class="axis" x1="{LEFT:g}" x2="{LEFT + wide:g}" y1="{middle:g}" y2="{middle:g}"/>'
    )


def _edges(base: TimeBase, per_ms: float) -> str:
    """Return a line at every edge of the keyphasor, with its time below."""
    bottom = TALL - BELOW
    parts = [_text(WIDE / 2, TALL - 30, "ms: the keyphasor's edges")]
    for edge in base.edges:
        x = LEFT + edge * per_ms
        parts.append(f'<line class="axis" x1="{x:.0f}" x2="{x:.0f}" y1="0" y2="{bottom:g}"/>')
        parts.append(_text(x, bottom + LETTERS, f"{edge:.1f}"))
    return "".join(parts)


def _at_edges(base: TimeBase, values: Reals) -> Reals:
    """Return values (sample, 2) at the keyphasor's edges, (edge, 2)."""
    return np.column_stack([np.interp(base.edges, base.t, column) for column in values.T])


def _line(points: Reals, kind: str) -> str:
    """Return a line through points (point, 2), in steps of whole units."""
    whole = np.round(points).astype(int)
    first, steps = whole[0], np.diff(whole, axis=0)
    moves = "".join(f"{dx}{dy:+d} " for dx, dy in steps.tolist())
    return f'<path class="{kind}" d="M{first[0]} {first[1]}l{moves}"/>'


def _dots(points: Reals) -> str:
    return "".join(f'<circle class="keyphasor" cx="{x:.0f}" cy="{y:.0f}" r="45"/>' for x, y in points)


def _text(x: float, y: float, words: str, anchor: str = "middle") -> str:
    place = f'x="{x:.0f}" y="{y:.0f}" font-size="{LETTERS:g}" text-anchor="{anchor}"'
    return f"<text {place}>{escape(words)}</text>"
