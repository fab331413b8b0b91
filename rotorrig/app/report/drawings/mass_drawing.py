"""A balancing plane as SVG: the mark at the top, the mass to mount with its 95 % region, the holes, the rotation.

Seen along the axis as the end view of the rig is, with x to the right and y up: a rotor that turns from x to y turns
counter-clockwise, and angles are counted that way from the mark.
"""

import math
from collections.abc import Callable

from rotorrig.app.report.drawings.svg import arrow, bent_arrow, svg, text
from rotorrig.app.text import mass_text
from rotorrig.balancing import Balance

RIM, HOLES, FULL = 60.0, 50.0, 38.0  # drawing units: the edge, the circle of the holes, the largest mass
OUTER = 71.0  # the circle of the angles
SPOKE = 30  # degrees


def plane_drawing(balance: Balance, plane: str, *, rotation: str) -> str:
    """Return one plane of a balance; `rotation` is "x-to-y" or "y-to-x"."""
    i = balance.planes.index(plane)
    sense = 1 if rotation == "x-to-y" else -1
    largest = max(float(abs(balance.mounted).max()), float(abs(balance.chosen.W).max()), 1e-300)

    def at(angle: float, radius: float) -> tuple[float, float]:
        """Return where an angle from the mark [rad] is drawn; the SVG's y points down."""
        way = math.pi / 2 + sense * angle
        return radius * math.cos(way), -radius * math.sin(way)

    def end(w: complex) -> tuple[float, float]:
        return at(math.atan2(w.imag, w.real), FULL * abs(w) / largest)

    parts = [f'<circle class="rim" r="{RIM:g}"/>', '<circle class="shaft" r="5"/>']
    parts += [f'<path class="mark" d="M-4 {-RIM - 7:g}h8l-4 6z"/>']
    for degrees in range(0, 360, SPOKE):
        x, y = at(math.radians(degrees), OUTER)
        parts.append(text(x, y + 3, f"{degrees}°" if degrees else "mark 0°", kind="angle"))
    parts += _holes(balance, i, at)
    reach = FULL * float(balance.chosen.reach[i]) / largest
    x, y = end(complex(balance.chosen.W[i]))
    parts.append(f'<circle class="region" cx="{x:.1f}" cy="{y:.1f}" r="{min(reach, RIM):.1f}"/>')
    if balance.mounted[i]:
        parts.append(arrow(0, 0, *end(complex(balance.mounted[i])), kind="mass"))
    a, b = (-128, -162) if sense > 0 else (-52, -18)
    parts += [bent_arrow(OUTER + 17, a, b), text(-sense * (OUTER + 14), -60, "rotation")]
    words = f"{plane}: add {mass_text(plane, complex(balance.mounted[i])).split(': ')[1]} from the mark"
    return svg((-112, -90, 224, 172), parts, words)


def _holes(balance: Balance, i: int, at: Callable[[float, float], tuple[float, float]]) -> list[str]:
    """Return the holes of plane `i`, numbered, those to fill marked."""
    if balance.placing is None:
        return []
    holes, filled = balance.placing.holes[i], dict(balance.placing.filled[i])
    parts = []
    for hole in range(1, holes.count + 1):
        x, y = at(holes.first + math.tau * (hole - 1) / holes.count, HOLES)
        kind = "hole filled" if hole in filled else "hole"
        parts.append(f'<circle class="{kind}" cx="{x:.1f}" cy="{y:.1f}" r="4.4"/>')
        parts.append(text(x, y + 2.2, str(hole), kind="hole", size=6))
    return parts
