"""A residual map in Rerun: sigmas of the noise over speed, a row for every probe and run."""

from collections.abc import Sequence

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from rotorrig.app.viewer.plots.axes import GRID, Panel, step_for, texts
from rotorrig.app.viewer.plots.words import displayable

WIDTH, HEIGHT = 200, 104  # view units; the height at the least
STOPS = (
    (0.0, (34, 38, 43)),
    (2.0, (70, 76, 83)),
    (3.0, (242, 193, 78)),
    (5.0, (230, 121, 43)),
    (8.0, (200, 24, 66)),
)


class ResidualPicture:
    """Residual map of a model as an image with axes; drawn once."""

    def __init__(self, stream: rr.RecordingStream, path: str) -> None:
        self._stream = stream
        self._path = path

    def draw(self, labels: Sequence[str], edges: NDArray[np.float64], grid: NDArray[np.float64]) -> None:
        """Draw sigmas (row, bin), NaN where nothing was measured, over speed edges [rpm] (bin + 1,).

        The bins should divide WIDTH evenly. Draws nothing without a row.
        """
        if not len(labels):
            return
        tall, wide = max(1, HEIGHT // len(labels)), max(1, WIDTH // grid.shape[1])
        image = np.kron(colour_sigmas(grid), np.ones((tall, wide, 1), dtype=np.uint8))
        self._log("map", rr.Image(image))
        panel = Panel(
            left=0, top=0, width=image.shape[1], height=image.shape[0], x=(edges[0], edges[-1]), y=(0, len(labels)),
            x_step=step_for(edges[-1] - edges[0], most=7), y_step=np.inf, x_title="speed, rpm",
        )  # fmt: skip
        panel.log(self._stream, f"{self._path}/axes", static=True)
        rows = [(-16.0, (i + 0.5) * tall, displayable(label)) for i, label in enumerate(labels)]
        stops = [(40.0 + 34 * i, -6.0, f"{s:g} σ") for i, (s, _) in enumerate(STOPS)]
        self._log("rows", texts([*rows, *stops]))
        swatches = rr.Points2D([(x - 9, y) for x, y, _ in stops], colors=[c for _, c in STOPS], radii=2.0)
        self._log("scale", swatches)

    def _log(self, name: str, what: rr.AsComponents) -> None:
        self._stream.log(f"{self._path}/{name}", what, static=True)


def colour_sigmas(grid: NDArray[np.float64]) -> NDArray[np.uint8]:
    """Return sigmas (row, bin) as colours (row, bin, 3); what was not measured takes the grid's colour."""
    at = [stop for stop, _ in STOPS]
    channels = [np.interp(grid, at, [colour[k] for _, colour in STOPS]) for k in range(3)]
    image = np.stack(channels, axis=-1)
    image[~np.isfinite(grid)] = GRID
    return image.astype(np.uint8)
