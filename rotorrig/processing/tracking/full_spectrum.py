"""Full spectrum of a probe plane: the parts of the motion that whirl with the rotor's rotation and against it.

Two probes give the orbit x + jy, whose spectrum has two sides: a component c e^{jn theta} is a circle of radius |c|
that is run through forward, in the rotor's own sense, for n > 0 and backward for n < 0. Amplitudes are these radii, so
0-peak; a line of amplitude r is r/2 at +n and r/2 at -n. Whichever way the rotor turns, forward is positive.

Two kinds: the order vectors of a response as forward and backward vectors with their covariance (`whirl_vectors`), and
the amplitudes over all orders between -N and N of some turns (`full_spectrum`).

Goldman and Muszynska, Application of full spectrum to rotating machinery diagnostics, Orbit 20 (1999), first quarter.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotorrig.processing.probe_planes import Plane, measured_planes, whirl
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.processing.shaft_angle import TURN
from rotorrig.processing.windows import hann

HIGHEST = 4.0  # order of a cascade on either side


@dataclass(frozen=True, slots=True, kw_only=True)
class WhirlVectors:
    """+nX and -nX of one plane over the rows of a response: orbit = f e^{jn theta} + b* e^{-jn theta} for x to y."""

    plane: Plane
    order: float
    forward: NDArray[np.complex128]  # (row,) m, radius of the circle
    backward: NDArray[np.complex128]  # (row,) m
    covariance: NDArray[np.float64]  # (row, 4, 4) m^2 of (re f, im f, re b, im b)
    usable: NDArray[np.bool_]  # (row,) both probes are

    @property
    def sigma(self) -> NDArray[np.float64]:
        """One standard deviation of the real or imaginary part, (row, 2) [m]: forward, backward."""
        variance = np.diagonal(self.covariance, axis1=1, axis2=2)
        return np.sqrt((variance[:, 0::2] + variance[:, 1::2]) / 2)


def whirl_vectors(
    response: OrderTrackedResponse, *, order: float = 1.0, compensated: bool = False
) -> tuple[WhirlVectors, ...]:
    """Return +nX and -nX of every plane with both probes in the response; order 0 has none.

    `compensated`: less the slow-roll vector, NaN without one; its covariance is not added, since it is the same in
    all rows. Amplitudes alone have none.
    """
    if response.amplitudes_alone:
        return ()
    z = response.compensated(order) if compensated else response.order(order)
    covariance = response.covariance[:, response.orders.index(order)]
    vectors = []
    for plane, places in measured_planes(response.rig, response.probes):
        forward, backward = whirl(plane, z[:, places], rotation=response.rig.rotation)
        turn = _real_map(plane, response.rig.rotation)
        pairs = np.array([2 * place + part for place in places for part in (0, 1)])
        vectors.append(
            WhirlVectors(
                plane=plane,
                order=order,
                forward=forward,
                backward=backward,
                covariance=turn @ covariance[:, pairs[:, None], pairs] @ turn.T,
                usable=np.asarray(response.usable[:, places].all(axis=1)),
            )
        )
    return tuple(vectors)


def full_spectrum(
    x: NDArray[np.float64], *, plane: Plane, rotation: str, turns: int, highest: float = HIGHEST
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the orders (bin,), rising from -N to N, and the amplitude (bin,) at each in the unit of `x`, 0-peak.

    `x` (point, 2) are the readings of the plane's two probes at equal steps of angle over `turns` turns; `rotation` is
    "x-to-y" or "y-to-x", as in the config. Under a Hann window: a line at a whole order also shows half of itself at
    either neighbour, 1 / turns away. The mean under the window is taken out first, so order 0 is zero.
    """
    orbit = (x @ plane.to_xy.T) @ np.array([1.0, 1j if rotation == "x-to-y" else -1j])
    psi = TURN * turns * (np.arange(len(orbit)) / len(orbit) - 0.5)
    weight = hann(psi, turns=turns)
    weight = weight / weight.sum()
    spectrum = np.fft.fft(weight * (orbit - weight @ orbit))
    order = _orders(turns, highest)
    return order, np.abs(spectrum[np.round(order * turns).astype(int)])


def _orders(turns: int, highest: float) -> NDArray[np.float64]:
    top = int(highest * turns)
    return np.arange(-top, top + 1) / turns


def _real_map(plane: Plane, rotation: str) -> NDArray[np.float64]:
    """Return the (4, 4) matrix from (re z_1, im z_1, re z_2, im z_2) to (re f, im f, re b, im b)."""
    basis = np.array([[1, 0], [1j, 0], [0, 1], [0, 1j]])
    forward, backward = whirl(plane, basis, rotation=rotation)
    return np.stack([forward.real, forward.imag, backward.real, backward.imag])
