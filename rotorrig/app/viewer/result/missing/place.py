"""A place along the shaft in Rerun: how probable each is, above the rotor to the same scale."""

from collections.abc import Iterator

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from rotorrig.app.plot_data import nice
from rotorrig.app.viewer.plots import DOWN, INK, UP, Colour, Panel, legend, merge_labels, step_for
from rotorrig.rig.config import RigConfig

WIDTH, HEIGHT = 186.0, 46.0  # view units, of the axes
BELOW, LINE = 21.0, 8.0  # from the axes to the rotor; between lines of names
NAMES_APART = 0.06  # of the shaft's length
SHAFT, DISK = (150, 158, 168), (96, 132, 168)


class LikelyPlacePicture:
    """The probability of every place, with shaft, disks, bearings and probes below it; drawn once."""

    def __init__(self, stream: rr.RecordingStream, path: str, rig: RigConfig) -> None:
        self._stream = stream
        self._path = path
        self._rig = rig
        self._per_m = WIDTH / rig.shaft.length

    def draw(self, places: NDArray[np.float64], probability: NDArray[np.float64], colour: Colour) -> None:
        """Draw probabilities (place,) at places (place,) [m] from the coupling."""
        length, top = self._rig.shaft.length * 1e3, nice(100 * float(probability.max()))
        panel = Panel(
            left=0, top=0, width=WIDTH, height=HEIGHT, x=(0.0, length), y=(0.0, top), x_step=step_for(length, most=8),
            y_step=step_for(top, most=4), title="probability of each place, %", x_title="mm from the coupling",
        )  # fmt: skip
        panel.log(self._stream, f"{self._path}/axes", static=True)
        curve = panel.place(places * 1e3, 100 * probability)
        stems = [[(x, y), (x, HEIGHT)] for x, y in curve]
        self._log("stems", rr.LineStrips2D(stems, colors=colour, radii=-0.5, draw_order=1.0))
        self._log("curve", rr.LineStrips2D([curve], colors=colour, radii=-1.2, draw_order=2.0))
        self._draw_rotor()

    def _draw_rotor(self) -> None:
        rig, per_m = self._rig, self._per_m
        tallest = max([rig.shaft.diameter, *(disk.diameter for disk in rig.disks)]) * per_m
        axis = HEIGHT + BELOW + tallest / 2
        tubes = [(t.start, t.length, t.diameter, SHAFT) for t in rig.shaft.tubes]
        disks = [(d.position - d.width / 2, d.width, d.diameter, DISK) for d in rig.disks]
        boxes = [*tubes, *disks]
        middles = [((start + width / 2) * per_m, axis) for start, width, _, _ in boxes]
        halves = [(width * per_m / 2, height * per_m / 2) for _, width, height, _ in boxes]
        self._log("rotor", rr.Boxes2D(centers=middles, half_sizes=halves, colors=[c for *_, c in boxes], radii=-1.0))
        below = axis + tallest / 2 + LINE
        for line, (name, places, colour) in enumerate(self._marks()):
            ends = [[(at * per_m, axis), (at * per_m, below + line * LINE - 3.0)] for at, _ in places]
            self._log(name, rr.LineStrips2D(ends, colors=colour, radii=-0.6))
            words = [(words, colour) for _, words in places]
            self._log(f"{name}/names", legend(words, [(at * per_m, below + line * LINE) for at, _ in places]))

    def _marks(self) -> Iterator[tuple[str, list[tuple[float, str]], Colour]]:
        """Yield disks, bearings and probes: their places [m] with names, near ones joined."""
        for name, parts, colour in (
            ("disks", self._rig.disks, INK),
            ("bearings", self._rig.bearings, DOWN),
            ("probes", self._rig.probes, UP),
        ):
            named = [(part.position, part.name) for part in parts]
            yield name, merge_labels(named, apart=NAMES_APART * self._rig.shaft.length), colour

    def _log(self, name: str, what: rr.AsComponents) -> None:
        self._stream.log(f"{self._path}/{name}", what, static=True)
