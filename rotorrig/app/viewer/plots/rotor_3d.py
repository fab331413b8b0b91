"""The rotor in Rerun, to scale: shaft, disks, bearings and probes, and a whirling deflection, drawn larger than it is.

The scene's X runs along the shaft from the coupling, its Y is the rig's x (horizontal), its Z the rig's y (up): metres.
"""

from collections.abc import Sequence

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from rotorrig.app.viewer.plots.axes import INK, SOFT
from rotorrig.app.viewer.plots.words import displayable
from rotorrig.rig.config import RigConfig

FORWARD = (86, 196, 150)
BACKWARD = (226, 104, 158)
NEITHER = (186, 192, 200)  # along a line
LINE_LIKE = 0.02  # of a circle's area: an orbit flatter than that whirls neither way
STEEL = (150, 158, 168)
DISK = (96, 132, 168)
GROUND = (84, 92, 102)
PROBE = (242, 193, 78)
TURN = np.linspace(0.0, 2 * np.pi, 73)
MOST_ORBITS = 15  # along the shaft
PROBE_GAP = 1.3e-3  # m: where a proximity probe is set, within its linear range
PROBE_LENGTH = 0.03  # m
Colour = tuple[int, int, int]
Reals = NDArray[np.float64]
Complex = NDArray[np.complex128]


class RotorPicture:
    """One rotor, drawn once, and what moves: centreline, disks and orbits."""

    def __init__(self, stream: rr.RecordingStream, path: str, rig: RigConfig) -> None:
        self._stream = stream
        self._path = path
        self._rig = rig
        self._draw_rig()

    def whirl(self, z: Reals, shape: Complex, *, scale: float, static: bool = False) -> None:
        """Draw the orbits of a motion Re(shape e^{j angle}), x and y (2, node) at z (node,) [m], times `scale`.

        An orbit is coloured by its own sense: with the rotation, against it, or along a line.
        """
        shown = self._places(len(z))
        loops = [orbit_loop(z[i], scale * shape[:, i]) for i in shown]
        self._log(
            "moving/whirl", rr.LineStrips3D(loops, colors=self._colours(shape[:, shown]), radii=-1.4), static=static
        )

    def bend(self, z: Reals, shape: Complex, *, angle: float, scale: float) -> None:
        """Draw shaft and disks where that motion has them at `angle` [rad], and dots on the orbits."""
        moved = place(z, scale * (shape * np.exp(1j * angle)).real)
        self._log("moving/shaft", rr.LineStrips3D([moved], radii=self._rig.shaft.diameter / 2, colors=STEEL))
        self._draw_disks(z, moved)
        shown = self._places(len(z))
        self._log("moving/now", rr.Points3D(moved[shown], colors=self._colours(shape[:, shown]), radii=-3.0))

    def orbits(self, name: str, z: Sequence[float], vectors: Complex, colour: Colour, *, scale: float) -> None:
        """Draw orbits called `name`, of vectors x and y (2, place) [m] at `z` (place,) [m], times `scale`."""
        loops = [orbit_loop(at, scale * vectors[:, i]) for i, at in enumerate(z)]
        self._log(f"moving/{name}", rr.LineStrips3D(loops, colors=colour, radii=-2.2))

    def say(self, words: str) -> None:
        """Write `words` above the rotor."""
        at = (self._rig.shaft.length / 2, 0.0, 0.22 * self._rig.shaft.length)
        self._log("moving/words", _labels([at], [words], INK))

    def _places(self, nodes: int) -> NDArray[np.intp]:
        """Return the nodes that get an orbit."""
        return np.unique(np.linspace(0, nodes - 1, MOST_ORBITS).round().astype(int))

    def _colours(self, vectors: Complex) -> list[Colour]:
        """Return the colours of orbits, x and y (2, orbit)."""
        turning = 1 if self._rig.rotation == "x-to-y" else -1
        return [sense_colour(turning * sense(vectors[:, i])) for i in range(vectors.shape[1])]

    def _draw_rig(self) -> None:
        length, radius = self._rig.shaft.length, self._rig.shaft.diameter / 2
        axis = rr.LineStrips3D([[(0, 0, 0), (length, 0, 0)]], colors=SOFT, radii=-0.6)
        self._log("rig", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
        self._log("rig/axis", axis, static=True)
        self._draw_bearings(3 * radius)
        self._draw_probes(radius + PROBE_GAP)
        self._draw_directions(0.15 * length)

    def _draw_disks(self, z: Reals, moved: Reals) -> None:
        disks = self._rig.disks
        if not disks:
            return
        at = [d.position for d in disks]
        centres = np.column_stack([np.interp(at, z, moved[:, i]) for i in range(3)])
        slopes = np.column_stack([np.interp(at, z, np.gradient(moved[:, i], z)) for i in range(3)])
        self._log(
            "moving/disks",
            rr.Cylinders3D(
                lengths=[d.width for d in disks], radii=[d.diameter / 2 for d in disks], centers=centres,
                quaternions=[_rotation_to(slope) for slope in slopes], colors=DISK,
                fill_mode=rr.components.FillMode.TransparentFillMajorWireframe,
            ),
        )  # fmt: skip

    def _draw_bearings(self, radius: float) -> None:
        bearings, floor = self._rig.bearings, -1.2 * max([d.diameter / 2 for d in self._rig.disks], default=0.03)
        along = _rotation_to(np.array([1.0, 0.0, 0.0]))
        rings = rr.Cylinders3D(
            lengths=[0.01] * len(bearings), radii=[radius] * len(bearings), colors=GROUND,
            centers=[(b.position, 0, 0) for b in bearings], quaternions=[along] * len(bearings),
            fill_mode=rr.components.FillMode.TransparentFillMajorWireframe,
        )  # fmt: skip
        feet = [[(b.position, 0, -radius), (b.position, 0, floor)] for b in bearings]
        base = [[(0, 0, floor), (self._rig.shaft.length, 0, floor)]]
        self._log("rig/bearings", rings, static=True)
        self._log("rig/ground", rr.LineStrips3D([*feet, *base], colors=GROUND, radii=-1.5), static=True)
        labels = merge_labels([(b.position, b.name) for b in bearings], apart=0.06 * self._rig.shaft.length)
        self._labels("bearings", [(at, 0, floor) for at, _ in labels], [words for _, words in labels], SOFT)
        tops = [(d.position, 0, 1.15 * d.diameter / 2) for d in self._rig.disks]
        self._labels("disks", tops, [d.name for d in self._rig.disks], INK)

    def _draw_probes(self, tip: float) -> None:
        ways = [(0.0, np.cos(p.angle), np.sin(p.angle)) for p in self._rig.probes]
        starts = [np.array([p.position, 0.0, 0.0]) for p in self._rig.probes]
        lines = [a + np.outer([tip, tip + PROBE_LENGTH], way) for a, way in zip(starts, ways, strict=True)]
        self._log("rig/probes", rr.LineStrips3D(lines, colors=PROBE, radii=2.5e-3), static=True)
        outer = [tuple(line[1] + 0.012 * np.array(way)) for line, way in zip(lines, ways, strict=True)]
        self._labels("probes", outer, [p.name for p in self._rig.probes], PROBE)

    def _draw_directions(self, size: float) -> None:
        """Draw the rig's axes at the coupling, and an arc in the sense of rotation."""
        start = (-0.4 * size, 0.0, 0.0)
        axes = ((0.0, size, 0.0), (0.0, 0.0, size))
        arrows = rr.Arrows3D(origins=[start] * 2, vectors=axes, colors=SOFT, radii=-1.2)
        self._log("rig/directions", arrows, static=True)
        self._labels("directions", [(start[0], 1.1 * y, 1.1 * z) for _, y, z in axes], ["x", "y"], SOFT)
        way = 1 if self._rig.rotation == "x-to-y" else -1
        arc = way * np.radians(np.linspace(15.0, 75.0, 12)) + (0.0 if way > 0 else np.pi / 2)
        line = np.column_stack([np.full(12, start[0]), 0.6 * size * np.cos(arc), 0.6 * size * np.sin(arc)])
        head = rr.Arrows3D(origins=[line[-2]], vectors=[line[-1] - line[-2]], colors=SOFT, radii=-1.2)
        self._log("rig/rotation", rr.LineStrips3D([line], colors=SOFT, radii=-1.2), static=True)
        self._log("rig/rotation/head", head, static=True)

    def _labels(self, name: str, places: Sequence[tuple[float, ...]], words: Sequence[str], colour: Colour) -> None:
        self._log(f"rig/{name}/names", _labels(places, words, colour), static=True)

    def _log(self, name: str, what: rr.AsComponents, *, static: bool = False) -> None:
        self._stream.log(f"{self._path}/{name}", what, static=static)


def _labels(places: Sequence[tuple[float, ...]], words: Sequence[str], colour: Colour) -> rr.Points3D:
    """Return words at places (point, 3), without a dot."""
    shown = [displayable(word) for word in words]
    return rr.Points3D(places, labels=shown, show_labels=True, radii=-0.01, colors=colour)


def place(z: Reals, xy: Reals) -> Reals:
    """Return the scene's points (node, 3) of x and y (2, node) at z (node,)."""
    return np.column_stack([z, xy[0], xy[1]])


def orbit_loop(z: float, vectors: Complex) -> Reals:
    """Return the scene's points (point, 3) of one turn of x and y (2,) at z, the first at angle 0."""
    xy = (vectors[:, None] * np.exp(1j * TURN)).real
    return place(np.full(len(TURN), z), xy)


def sense(vectors: Complex) -> float:
    """Return which way x and y (2,) go round: +1 a circle from x towards y, -1 one from y towards x, 0 a line.

    >>> sense(np.array([1.0, -1.0j])), sense(np.array([1.0, 1.0j])), sense(np.array([1.0 + 0j, 2.0]))
    (1.0, -1.0, 0.0)
    """
    x, y = vectors
    size = float(abs(x) ** 2 + abs(y) ** 2)
    return float(-2 * (np.conj(x) * y).imag / size) + 0.0 if size else 0.0


def sense_colour(forward: float) -> Colour:
    """Return the colour of a whirl: `forward` from +1, with the rotation, to -1, against it."""
    if abs(forward) < LINE_LIKE:
        return NEITHER
    return FORWARD if forward > 0 else BACKWARD


def merge_labels(named: Sequence[tuple[float, str]], *, apart: float) -> list[tuple[float, str]]:
    """Return places and names, in order along the shaft, those nearer than `apart` [m] joined at their middle."""
    groups: list[list[tuple[float, str]]] = []
    for at, name in sorted(named):
        if groups and at - groups[-1][-1][0] < apart:
            groups[-1].append((at, name))
        else:
            groups.append([(at, name)])
    return [(sum(at for at, _ in group) / len(group), ", ".join(name for _, name in group)) for group in groups]


def _rotation_to(direction: Reals) -> rr.Quaternion:
    """Return the rotation that takes the Z axis, a cylinder's own, to `direction` (3,)."""
    way = direction / np.linalg.norm(direction)
    xyzw = np.array([-way[1], way[0], 0.0, 1.0 + way[2]])  # half-way between the two; Z and -Z never meet here
    return rr.Quaternion(xyzw=xyzw / np.linalg.norm(xyzw))
