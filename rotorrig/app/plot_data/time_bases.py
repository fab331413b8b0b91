"""Time bases of a recording at a few speeds: some turns of what the probes read, and their part at 1X."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotorrig.app.plot_data.curves import sweeps
from rotorrig.app.plot_data.speed_spectra import row_of_largest
from rotorrig.processing import OrderTrackedResponse, Plane, Waveforms, measured_planes
from rotorrig.rig.config import RPM, UM

TURNS = 4
Reals = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class TimeBase:
    """Some turns at one plane: raw, which is neither filtered nor slow-roll compensated, only its mean is out."""

    plane: Plane
    speed: str  # what speed it is, in words
    rpm: float
    t: Reals  # (sample,) ms from the first keyphasor edge
    raw: Reals  # (sample, 2) µm along each probe
    filtered: Reals  # (sample, 2) µm, the 1X vector of the row at the same angles, slow roll included
    edges: Reals  # (turn + 1,) ms, of the keyphasor

    @property
    def orbit(self) -> Reals:
        """Raw orbit (sample, 2) [µm], x and y."""
        return self.raw @ self.plane.to_xy.T

    @property
    def filtered_orbit(self) -> Reals:
        """Orbit at 1X (sample, 2) [µm], x and y."""
        return self.filtered @ self.plane.to_xy.T

    @property
    def beside(self) -> float:
        """Root mean square of what is not 1X [µm], of both probes."""
        return float(np.sqrt(np.mean((self.raw - self.filtered) ** 2)))


def time_bases(response: OrderTrackedResponse, waveforms: Waveforms) -> tuple[TimeBase, ...]:
    """Return TURNS turns of every plane at slow roll, at the largest 1X of the first sweep and at the top speed.

    `waveforms` are those the response was tracked from. Where samples or edges are missing there is none; where two of
    these speeds are one row, one.
    """
    wanted = [(speed, row, _turns(response, row)) for row, speed in rows_to_show(response).items()]
    return tuple(
        made
        for plane, columns in measured_planes(response.rig, response.probes)
        for speed, row, edges in wanted
        if edges is not None
        and (made := _time_base(response, waveforms, plane, columns, row, edges, speed)) is not None
    )


def rows_to_show(response: OrderTrackedResponse) -> dict[int, str]:
    """Return the rows of these speeds and what to call them."""
    if 1.0 not in response.orders:
        return {}
    known = np.flatnonzero(np.isfinite(response.t) & np.isfinite(response.order(1.0)).any(axis=1))
    if not len(known):
        return {}
    slow = response.slow_roll_omega
    aim, word = (slow, "slow roll") if np.isfinite(slow) else (0.0, "slowest")
    rows = {int(known[np.argmin(np.abs(response.omega[known] - aim))]): word}
    if sweeps(response) and (peak := row_of_largest(response, sweeps(response)[0])) is not None:
        rows.setdefault(peak, "largest 1X")
    rows.setdefault(int(known[np.argmax(response.omega[known])]), "top speed")
    return rows


def _turns(response: OrderTrackedResponse, row: int) -> Reals | None:
    """Return the edges (turn + 1,) [s] of the turns about a row; None where they are not known."""
    middle = int(np.searchsorted(response.keyphasor_t, response.t[row]))
    first = middle - TURNS // 2
    if first < 0 or first + TURNS >= len(response.keyphasor_t):
        return None
    return response.keyphasor_t[first : first + TURNS + 1]


def _time_base(
    response: OrderTrackedResponse,
    waveforms: Waveforms,
    plane: Plane,
    columns: list[int],
    row: int,
    edges: Reals,
    speed: str,
) -> TimeBase | None:
    z = response.order(1.0)[row, columns]
    stretch = waveforms.between(edges[0], edges[-1])
    if stretch is None or len(stretch.t) < 2 * TURNS or not np.isfinite(z).all():
        return None
    names = [probe.name for probe in response.rig.probes]
    x = stretch.x[:, [names.index(name) for name in plane.probes]]
    angle = 2 * np.pi * np.interp(stretch.t, edges, np.arange(len(edges)))
    return TimeBase(
        plane=plane,
        speed=speed,
        rpm=float(response.omega[row]) * RPM,
        t=(stretch.t - edges[0]) * 1e3,
        raw=(x - x.mean(axis=0)) * UM,
        filtered=np.outer(np.exp(1j * angle), z).real * UM,
        edges=(edges - edges[0]) * 1e3,
    )
