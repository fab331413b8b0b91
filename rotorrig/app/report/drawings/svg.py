"""Elements of the SVG drawings: the drawing itself, text, straight and bent arrows; degrees, y points down."""

import math
from collections.abc import Iterable
from html import escape

LETTERS = 9.0  # drawing units, height
TIP = 6.0  # long


def svg(box: tuple[float, float, float, float], parts: Iterable[str], description: str) -> str:
    """Return a drawing with its description for screen readers; `box` is left, top, width, height."""
    size = " ".join(f"{v:.1f}" for v in box)
    return f'<svg class="drawing" viewBox="{size}" role="img" aria-label="{escape(description)}">{"".join(parts)}</svg>'


def text(x: float, y: float, words: str, *, anchor: str = "middle", kind: str = "", size: float = LETTERS) -> str:
    """Return a line of text that begins, ends or has its middle at a place."""
    place = f'x="{x:.2f}" y="{y:.2f}" font-size="{size:g}" text-anchor="{anchor}"'
    return f'<text class="{kind}" {place}>{escape(words)}</text>'


def arrow(x1: float, y1: float, x2: float, y2: float, *, kind: str = "") -> str:
    """Return a straight arrow."""
    line = f'<line class="arrow {kind}" x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}"/>'
    return line + _tip(x2, y2, math.degrees(math.atan2(y2 - y1, x2 - x1)), kind)


def bent_arrow(radius: float, start: float, end: float) -> str:
    """Return an arrow along less than half a circle about the origin; y points down: -90 is above."""
    (x1, y1), (x2, y2) = (
        (radius * math.cos(math.radians(a)), radius * math.sin(math.radians(a))) for a in (start, end)
    )
    way = f"M{x1:.2f} {y1:.2f}A{radius:g} {radius:g} 0 0 {int(end > start)} {x2:.2f} {y2:.2f}"
    return f'<path class="arrow" d="{way}"/>' + _tip(x2, y2, end + math.copysign(90.0, end - start), "")


def _tip(x: float, y: float, heading: float, kind: str) -> str:
    turn = f"translate({x:.1f} {y:.1f}) rotate({heading:.1f})"
    return f'<path class="tip {kind}" transform="{turn}" d="M{-TIP:g} {-TIP / 2:g} 0 0 {-TIP:g} {TIP / 2:g}z"/>'
