"""What a response of a run-up in closed form is off by, and how often its intervals hold the truth."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from benchmarks.parts.tracking.signal import RunUp
from rotorrig.processing import OrderTrackedResponse

Reals = NDArray[np.float64]
Complex = NDArray[np.complex128]

NORMAL95 = 1.959964  # sigma: half of a 95 % interval of a normal error
POINTS = 4001  # of the mean under a window


@dataclass(frozen=True, slots=True, kw_only=True)
class Score:
    """How far the usable rows' vectors of one order are from the truth, over all rows and probes."""

    vector_percent: float  # rms of |z - truth| / |truth|
    amplitude_percent: float  # rms of |z| / |truth| - 1
    phase_deg: float  # rms of the phase's error
    worst_percent: float
    usable: float  # share of rows and probes

    @classmethod
    def of(cls, z: Complex, truth: Complex, usable: NDArray[np.bool_]) -> "Score":
        """Compare z (row, probe) with the truth, one vector per probe or (row, probe)."""
        ratio = (z / truth)[usable]
        error = np.abs(ratio - 1)
        return cls(
            vector_percent=100 * rms(error),
            amplitude_percent=100 * rms(np.abs(ratio) - 1),
            phase_deg=float(np.degrees(rms(np.angle(ratio)))),
            worst_percent=100 * float(error.max()),
            usable=float(usable.mean()),
        )


@dataclass(slots=True)
class Coverage:
    """How many 95 % intervals were asked for, and how many of them held the truth, by (order, part)."""

    asked: dict[tuple[float, str], int] = field(default_factory=dict)
    held: dict[tuple[float, str], int] = field(default_factory=dict)

    def add(self, response: OrderTrackedResponse, run: RunUp, orders: tuple[float, ...]) -> None:
        """Count the intervals of both parts of every usable vector; of order 0 there is but the real one."""
        for order in orders:
            off = response.order(order) - run.truth(order)
            sigma = np.sqrt(np.diagonal(response.covariance[:, response.orders.index(order)], axis1=1, axis2=2))
            for part, error, mine in (("re", off.real, sigma[:, 0::2]), ("im", off.imag, sigma[:, 1::2])):
                if order or part == "re":
                    inside = (np.abs(error) <= NORMAL95 * mine)[response.usable]
                    key = (order, part)
                    self.asked[key] = self.asked.get(key, 0) + inside.size
                    self.held[key] = self.held.get(key, 0) + int(inside.sum())

    def share(self, order: float | None = None) -> float:
        """Return which share held the truth: of one order, or of all."""
        keys = [key for key in self.asked if order is None or key[0] == order]
        return sum(self.held[key] for key in keys) / sum(self.asked[key] for key in keys)

    def extremes(self) -> tuple[float, float]:
        """Return the smallest and the largest share of any order and part."""
        shares = [self.held[key] / self.asked[key] for key in self.asked]
        return min(shares), max(shares)


def windowed_truth(run: RunUp, response: OrderTrackedResponse) -> Complex:
    """Return what the 1X of each row should be, (row, probe): the mean of its vector under the record's window.

    By quadrature over the shaft angle, the weights as docs/response-file.md states them.
    """
    s = np.linspace(-1, 1, POINTS)  # of half of the row
    weight = _WEIGHTS[response.window](s)
    centre = run.theta(response.t)[:, None]
    omega = run.omega(centre + np.pi * response.revolutions[:, None] * s)
    moving = np.zeros((len(response.t), run.probes), complex)
    if run.resonance:
        moving = np.einsum("s,rsp->rp", weight / weight.sum(), run.resonance.at(omega))
    return run.truth(1.0) + moving


def instant_truth(run: RunUp, response: OrderTrackedResponse) -> Complex:
    """Return the 1X at the middle of each row, (row, probe)."""
    omega = run.omega(run.theta(response.t))
    return run.truth(1.0) + (run.resonance.at(omega) if run.resonance else 0.0)


def rms(values: Reals) -> float:
    """Return the root mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


def _kalman(s: Reals) -> Reals:
    u = 2.5 * np.pi * np.abs(s)
    return np.exp(-u) * (np.cos(u) + np.sin(u))


_WEIGHTS = {
    "hann": lambda s: 1 + np.cos(np.pi * s),
    "blackman": lambda s: 0.42 + 0.5 * np.cos(np.pi * s) + 0.08 * np.cos(2 * np.pi * s),
    "vold-kalman": _kalman,
}
