"""The rig as SVG: side view to scale, end view with axes, probe angles and sense of rotation."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from rotorrig.app.report.drawings.svg import LETTERS, arrow, bent_arrow, svg, text
from rotorrig.rig.config import Probe, RigConfig

Reals = NDArray[np.float64]

MARGIN = 26.0  # mm of paper left and right of the shaft
LANE = 12.0  # mm between lines of labels
LETTER = 0.56  # of the height: the width a letter takes on average


def side_view(
    rig: RigConfig, *, likely: tuple[Reals, Reals] | None = None, marked: Sequence[tuple[float, str]] = ()
) -> str:
    """Return shaft, disks, bearings and probes as an SVG, to scale, in millimetres from the coupling.

    `likely` are places [m] and the probability of each, which are shaded; `marked` are places [m] to point at, with
    what is there.
    """
    length, tallest = rig.shaft.length * 1e3, max([d.diameter for d in rig.disks] + [rig.shaft.diameter]) * 1e3
    above = [(p, _names(names, p), "probe") for p, names in _by_position(rig.probes)]
    above += [(d.position * 1e3, f"{d.name}, {d.position * 1e3:g}", "disk") for d in rig.disks]
    below = [(b.position * 1e3, f"{b.name}, {b.position * 1e3:g}", "bearing") for b in rig.bearings]
    above += [(place * 1e3, words, "found") for place, words in marked]
    top, upper = _labels(above, start=-tallest / 2 - 16, step=-LANE)
    bottom, lower = _labels(below, start=rig.shaft.diameter * 500 + 34, step=LANE)
    floor = max(lower, tallest / 2 + 6)
    parts = [
        *(_region(*likely, height=tallest / 2) if likely else ()),
        *(_disk(d.position * 1e3, d.width * 1e3, d.diameter * 1e3) for d in rig.disks),
        *(_tube(t.start * 1e3, t.length * 1e3, t.diameter * 1e3) for t in rig.shaft.tubes),
        *(_bearing(b.position * 1e3, rig.shaft.diameter * 500) for b in rig.bearings),
        *(_probe(p, rig.shaft.diameter * 500) for p, _ in _by_position(rig.probes)),
        *(_ring(place, rig) for place, _ in marked),
        *top,
        *bottom,
        _ruler(length, floor + 8),
    ]
    box = (-MARGIN, upper - LETTERS, length + 2 * MARGIN, floor + 34 - upper + LETTERS)
    found = [f"{words} at {place * 1e3:g} mm" for place, words in marked]
    return svg(box, parts, _description(rig, found))


def end_view(rig: RigConfig) -> str:
    """Return the axes, the probes at their angles, the sense of rotation and gravity as an SVG."""
    turn = 1 if rig.rotation == "x-to-y" else -1
    parts = ['<circle class="shaft" r="16"/>', arrow(0, 0, 62, 0), arrow(0, 0, 0, -62)]
    parts += [text(67, 3, "x", anchor="start"), text(0, -66, "y")]
    for angle in sorted({round(p.angle, 6) for p in rig.probes}):
        names = [p.name for p in rig.probes if round(p.angle, 6) == angle]
        parts += _probe_at(angle, names)
    a, b = (-140, -220) if turn > 0 else (-220, -140)  # degrees, the SVG's y points down
    parts.append(bent_arrow(27, a, b))
    parts.append(text(-36, 20, "rotation", anchor="end"))
    if rig.gravity != "none":
        x, y = (-52, 0) if rig.gravity == "-x" else (0, 52)
        parts += [
            arrow(x * 0.45, y * 0.45, x, y),
            text(x - 4 if x else 6, y + 4, "g", anchor="end" if x else "start"),
        ]
    first, second = rig.rotation.split("-to-")
    words = f"End view: x to the right, y up, rotation from {first} to {second}; probes at their angles."
    return svg((-95, -90, 190, 160), parts, words)


def _by_position(probes: tuple[Probe, ...]) -> list[tuple[float, list[str]]]:
    places = sorted({p.position for p in probes})
    return [(place * 1e3, [p.name for p in probes if p.position == place]) for place in places]


def _names(names: list[str], position: float) -> str:
    return f"{', '.join(names)}, {position:g}"


def _labels(items: list[tuple[float, str, str]], *, start: float, step: float) -> tuple[list[str], float]:
    """Lay labels in as few lines as keep them apart; returns the SVG parts and the y of the outermost line."""
    lanes: list[float] = []  # right end of the last label in each line
    parts = []
    for x, words, kind in sorted(items):
        half = len(words) * LETTERS * LETTER / 2 + 3
        lane = next((i for i, end in enumerate(lanes) if x - half > end), len(lanes))
        lanes[lane : lane + 1] = [x + half]
        y = start + lane * step
        near = y + 3 if step < 0 else y - LETTERS
        parts.append(f'<line class="leader" x1="{x:.2f}" x2="{x:.2f}" y1="{near:.2f}" y2="{start - step:.2f}"/>')
        parts.append(text(x, y, words, kind=kind))
    return parts, start + max(len(lanes) - 1, 0) * step


def _disk(x: float, width: float, diameter: float) -> str:
    return (
        f'<rect class="disk" x="{x - width / 2:.2f}" y="{-diameter / 2:.2f}" width="{width:.2f}" '
        f'height="{diameter:.2f}" rx="1.5"/>'
    )


def _tube(x: float, length: float, diameter: float) -> str:
    return f'<rect class="shaft" x="{x:.2f}" y="{-diameter / 2:.2f}" width="{length:.2f}" height="{diameter:.2f}"/>'


def _region(places: Reals, probability: Reals, *, height: float) -> list[str]:
    """Draw how probable each place is, as an area about the shaft that is highest at the most probable one."""
    up = height * probability / max(float(probability.max()), 1e-300)
    outline = [*zip(1e3 * places, -up, strict=True), *zip(1e3 * places[::-1], up[::-1], strict=True)]
    points = " ".join(f"{x:.2f},{y:.2f}" for x, y in outline)
    return [f'<polygon class="region" points="{points}"/>']


def _ring(place: float, rig: RigConfig) -> str:
    """Draw a ring about a place [m], with the disk that is there, else with a bearing's spring but not its name."""
    disks = [disk.diameter * 500 + 5 for disk in rig.disks if abs(disk.position - place) < disk.width / 2]
    height = max(disks, default=rig.shaft.diameter * 500 + 22)
    return f'<ellipse class="found" cx="{place * 1e3:.2f}" cy="0" rx="15" ry="{height:.2f}"/>'


def _bearing(x: float, radius: float) -> str:
    """Draw a spring to ground below the shaft."""
    y = radius
    zigzag = " ".join(
        f"{x + dx:.2f},{y + dy:.2f}" for dx, dy in ((0, 0), (0, 3), (4, 5), (-4, 9), (4, 13), (0, 15), (0, 18))
    )
    ground = f'<line class="bearing" x1="{x - 8:.2f}" x2="{x + 8:.2f}" y1="{y + 18:.2f}" y2="{y + 18:.2f}"/>'
    return f'<polyline class="bearing" points="{zigzag}"/>{ground}'


def _probe(x: float, radius: float) -> str:
    y = -radius - 2
    return f'<path class="probe" d="M{x:.2f} {y:.2f}l-2.5 -6v-9h5v9z"/>'


def _probe_at(angle: float, names: list[str]) -> list[str]:
    x, y = math.cos(angle), -math.sin(angle)
    body = f'<line class="probe-body" x1="{x * 19:.2f}" y1="{y * 19:.2f}" x2="{x * 36:.2f}" y2="{y * 36:.2f}"/>'
    words = f"{', '.join(names)} ({math.degrees(angle):g}°)"
    # beside the axis, so that a probe on it leaves the axis' own letter free
    side = ("start", 5.0) if x >= -0.1 else ("end", -5.0)
    return [body, text(x * 40 + side[1], y * 40 + (14 if abs(y) < 0.3 else 0), words, anchor=side[0], kind="probe")]


def _ruler(length: float, y: float) -> str:
    step = next(s for s in (10, 20, 50, 100, 200, 500, 1000, 2000, 5000) if length / s <= 8)
    ticks = [i * step for i in range(int(length // step) + 1)]
    marks = "".join(
        f'<line class="ruler" x1="{t}" x2="{t}" y1="{y:.2f}" y2="{y + 4:.2f}"/>{text(t, y + 14, str(t))}' for t in ticks
    )
    line = f'<line class="ruler" x1="0" x2="{length:.2f}" y1="{y:.2f}" y2="{y:.2f}"/>'
    return f"{line}{marks}{text(length, y + 24, 'mm from the coupling', anchor='end')}"


def _description(rig: RigConfig, found: Sequence[str]) -> str:
    across = "diameter" if len(rig.shaft.tubes) == 1 else "its largest diameter"
    shaft = f"Shaft {rig.shaft.length * 1e3:g} mm long, {rig.shaft.diameter * 1e3:g} mm in {across}"
    parts = [f"disk {d.name} at {d.position * 1e3:g} mm" for d in rig.disks]
    parts += [f"bearing {b.name} at {b.position * 1e3:g} mm" for b in rig.bearings]
    parts += [f"probe {p.name} at {p.position * 1e3:g} mm" for p in rig.probes]
    return "; ".join([shaft, *parts, *found]) + "."
