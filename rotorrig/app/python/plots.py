"""Figures of a response: Bode, polar, orbit, cascade; those of the report, for a notebook."""

from itertools import cycle

import numpy as np
import plotly.graph_objects as go
from numpy.typing import NDArray
from plotly.colors import qualitative

from rotorrig.app.plot_data import fits_of, orbit, order_spectra, vectors
from rotorrig.app.report.figures import bode, full_spectrum_map, polar
from rotorrig.identify import Identification
from rotorrig.processing import OrderTrackedResponse, Plane, measured_planes
from rotorrig.rig import DataError
from rotorrig.rig.config import RPM, UM

SIDE = 460  # px


class ResponsePlots:
    """Plotly figures of one response; `identification` draws its model beside the measurement."""

    def __init__(self, response: OrderTrackedResponse) -> None:
        self._response = response

    def bode(self, probe: str | None = None, *, identification: Identification | None = None) -> go.Figure:
        """Return 1X amplitude [µm 0-peak] and phase lag [deg] over speed, slow roll subtracted where it is known.

        `probe`: by default the one with the largest vector. Raises DataError for one that there is not.
        """
        number = self._probe(probe)
        figure = bode(self._response, number, prediction=self._prediction(identification))
        return self._finish(figure, f"{self._response.probes[number]}, 1X")

    def polar(self, probe: str | None = None, *, identification: Identification | None = None) -> go.Figure:
        """Return the 1X vectors over speed, as `bode`."""
        number = self._probe(probe)
        figure = polar(self._response, number, prediction=self._prediction(identification))
        return self._finish(figure, f"{self._response.probes[number]}, 1X")

    def orbit(self, *rpm: float, plane: int = 0) -> go.Figure:
        """Return the 1X orbits nearest to some speeds [rpm], by default where it is largest; a dot at the keyphasor.

        Raises DataError without a plane of two probes.
        """
        measured = [(each, list(pair)) for each, pair in measured_planes(self._response.rig, self._response.probes)]
        if plane >= len(measured):
            raise DataError(f"plane {plane}: the response has {len(measured)} planes of two probes, counted from 0")
        where, pair = measured[plane]
        z = np.where(self._response.usable[:, pair], vectors(self._response)[:, pair], np.nan)
        figure = go.Figure()
        for row, colour in zip(self._rows(z, rpm), cycle(qualitative.D3), strict=False):
            _draw_orbit(figure, where, z[row], self._response.omega[row] * RPM, colour)
        figure.update_xaxes(title="x, µm")
        figure.update_yaxes(title="y, µm", scaleanchor="x")
        figure.update_layout(width=SIDE + 120, height=SIDE)
        return self._finish(figure, f"1X orbit, {where.name}")

    def cascade(self, *, plane: int = 0, run: str | None = None) -> go.Figure:
        """Return the amplitude of every tracked order, forward and backward, over speed; `run`: the first by default.

        Raises DataError without a plane of two probes or that run.
        """
        spectra = list(order_spectra(self._response))
        names = list(dict.fromkeys(each.run for each in spectra))
        chosen = [each for each in spectra if each.run == (run or next(iter(names), None))]
        if plane >= len(chosen):
            raise DataError(
                f"cascade: no plane {plane} of two probes in run '{run or 'the first'}', want one of {', '.join(names)}"
            )
        figure = full_spectrum_map(chosen[plane])
        return self._finish(figure, f"{chosen[plane].plane.name}, {chosen[plane].run}: µm 0-peak")

    def _probe(self, name: str | None) -> int:
        response = self._response
        if name is None:
            size = np.where(response.usable, np.abs(vectors(response)), 0.0)
            return int(np.argmax(np.nan_to_num(size).max(axis=0)))
        if name not in response.probes:
            raise DataError(f"probe '{name}': the response has {', '.join(response.probes)}")
        return response.probes.index(name)

    def _prediction(self, identification: Identification | None) -> NDArray[np.complex128] | None:
        return fits_of(identification, self._response).fits[0].prediction if identification else None

    def _rows(self, z: NDArray[np.complex128], rpm: tuple[float, ...]) -> list[int]:
        known = np.flatnonzero(np.isfinite(z).all(axis=1))
        if not known.size:
            raise DataError("orbit: no row is usable on both probes of the plane")
        if not rpm:
            return [int(known[np.argmax(np.abs(z[known]).max(axis=1))])]
        speeds = self._response.omega[known] * RPM
        return [int(known[np.argmin(np.abs(speeds - wanted))]) for wanted in rpm]

    def _finish(self, figure: go.Figure, title: str) -> go.Figure:
        """Give a figure, made for a page that has headings and colours, its own."""
        figure.update_layout(
            template="plotly_white", title={"text": title, "x": 0.02}, margin_t=80, paper_bgcolor="white"
        )
        return figure


def _draw_orbit(figure: go.Figure, plane: Plane, z: NDArray[np.complex128], rpm: float, colour: str) -> None:
    x, y = orbit(plane, z).T * UM
    figure.add_scatter(x=x, y=y, mode="lines", name=f"{rpm:.0f} rpm", line={"color": colour})
    figure.add_scatter(
        x=x[:1],
        y=y[:1],
        mode="markers",
        marker={"size": 9, "color": colour},
        showlegend=False,
        hovertemplate="at the keyphasor edge<extra></extra>",
    )
