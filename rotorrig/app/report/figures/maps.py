"""Maps over speed: residual in sigmas and as whirl, full spectrum by order."""

from html import escape
from typing import Any

import numpy as np
import plotly.graph_objects as go
from numpy.typing import NDArray

from rotorrig.app.plot_data import OrderSpectrum, residual_grid, whirl_grid
from rotorrig.app.report.figures.look import apply_look, of_amplitudes
from rotorrig.processing import OrderTrackedResponse
from rotorrig.rig.config import UM

Reals = NDArray[np.float64]
Scale = list[list[float | str]]

SIGMA_CEILING = 8.0  # top of the residual colour scale: 8 sigma and 80 are equally wrong
#: calm to about 2 sigma, then ever louder
SIGMA_COLOURS: Scale = [
    [0.0, "rgba(128,136,144,0.10)"],
    [2.0 / SIGMA_CEILING, "rgba(128,136,144,0.35)"],
    [3.0 / SIGMA_CEILING, "#f2c14e"],
    [5.0 / SIGMA_CEILING, "#e6792b"],
    [1.0, "#b3123b"],
]
MICROMETRE_COLOURS: Scale = [[0.0, "rgba(128,136,144,0.10)"], [0.5, "#6aaed6"], [1.0, "#08306b"]]
ROW, LEAST_SCALE = 26, 104  # px: of a row; of a map of few, so that the numbers of its colour scale stay apart
DECADES = 3  # of the full spectrum's colours, below the largest amplitude


def residual_map(response: OrderTrackedResponse, sigmas: Reals, *, order: float = 1.0) -> go.Figure:
    """Return a map of the residual in standard deviations: speed across, a row per probe and run."""
    labels, edges, grid = residual_grid(response, sigmas, order=order)
    bar = {"tickvals": [0, 2, 3, 5, 8], "ticktext": ["0", "2", "3", "5", "8 +"]}
    return _map(labels, edges, grid, unit="σ", limits=(0.0, SIGMA_CEILING), colours=SIGMA_COLOURS, bar=bar)


def whirl_map(
    response: OrderTrackedResponse, residual: NDArray[np.complex128], *, noise: float = 0.0
) -> go.Figure | None:
    """Return a map of the 1X residual in µm as forward and backward whirl; None if no plane has two probes.

    `noise` is one sigma [m]; the colours reach at least as far up as those of `residual_map`, so that noise is calm.
    """
    labels, edges, grid = whirl_grid(response, residual)
    if not labels:
        return None
    quiet = SIGMA_CEILING * noise * UM if np.isfinite(noise) else 0.0
    ceiling = float(np.max(grid, initial=quiet, where=np.isfinite(grid)))
    figure = _map(labels, edges, grid, unit="µm", limits=(0.0, ceiling), colours=MICROMETRE_COLOURS)
    return of_amplitudes(figure, "z")


def full_spectrum_map(spectrum: OrderSpectrum) -> go.Figure:
    """Return a map of the amplitude of every order over speed, forward above backward, on a logarithmic scale."""
    top = float(np.max(spectrum.amplitude, initial=1e-3, where=np.isfinite(spectrum.amplitude)))
    ticks = 10.0 ** np.arange(np.floor(np.log10(top)) - DECADES, np.floor(np.log10(top)) + 1)
    with np.errstate(divide="ignore"):
        logarithm = np.log10(spectrum.amplitude)
    return _map(
        [f"{order:+g}X" for order in spectrum.orders],
        spectrum.edges,
        logarithm,
        unit="µm",
        limits=(float(np.log10(top)) - DECADES, float(np.log10(top))),
        colours=MICROMETRE_COLOURS,
        bar={"tickvals": np.log10(ticks), "ticktext": [f"{value:g}" for value in ticks]},
        reading=spectrum.amplitude,
    )


def _map(
    labels: list[str],
    edges: Reals,
    grid: Reals,
    *,
    unit: str,
    limits: tuple[float, float],
    colours: Scale,
    bar: dict[str, Any] | None = None,
    reading: Reals | None = None,
) -> go.Figure:
    """Return a map of `grid` (row, bin); `reading` are the values to be read where the colours stand for others."""
    heat = go.Heatmap(
        x=edges,
        y=[escape(label) for label in labels],
        z=np.round(grid, 3),
        customdata=np.round(grid if reading is None else reading, 3),
        zmin=limits[0],
        zmax=limits[1],
        colorscale=colours,
        ygap=2,
        hoverongaps=False,
        hovertemplate=f"%{{y}}, %{{x:.0f}} rpm: %{{customdata:.2f}} {unit}<extra></extra>",
        colorbar={"title": {"text": unit, "side": "top"}, "thickness": 12, "outlinewidth": 0, **(bar or {})},
    )
    figure = go.Figure(heat)
    figure.update_xaxes(title="speed, rpm", showgrid=False)
    figure.update_yaxes(autorange="reversed", showgrid=False, type="category")
    apply_look(figure, height=110 + max(ROW * len(labels), LEAST_SCALE))
    figure.update_layout(modebar_orientation="h")  # above the map, not across its scale
    return figure
