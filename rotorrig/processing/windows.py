"""Window functions of a row, over the shaft angle about its middle. Harris, Proc. IEEE 66 (1978) 51.

A Hann window lets 0.3 % of a line half an order away into a row of 8 turns, and white noise as through 1.5 / turns
orders; Blackman's, 0.09 % and as through 1.73 / turns.
"""

import numpy as np
from numpy.typing import NDArray

BLACKMAN = (0.42, 0.50, 0.08)  # zero with their slope at both ends, as Hann's (0.5, 0.5)
BLACKMAN_BANDWIDTH = 1.0 + 2 * (0.25**2 + 0.04**2) / 0.42**2  # 1.727, in 1 / turns: of white noise
HANN_BANDWIDTH = 1.5


def hann(psi: NDArray[np.float64], *, turns: float) -> NDArray[np.float64]:
    """Return Hann's window at angle psi [rad] from the middle of a row of `turns`; 0 with its slope at the ends."""
    return 1 + np.cos(psi / turns)


def blackman(psi: NDArray[np.float64], *, turns: float) -> NDArray[np.float64]:
    """Return Blackman's window at angle psi [rad] from the middle of a row of `turns`."""
    a, b, c = BLACKMAN
    return a + b * np.cos(psi / turns) + c * np.cos(2 * psi / turns)


def blackman_response(offset: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the response of Blackman's window at `offset` = (orders away) * turns: 1 at 0, 0 at 3, 4, 5 and so on."""
    a, b, c = BLACKMAN
    first = np.sinc(offset - 1) + np.sinc(offset + 1)
    second = np.sinc(offset - 2) + np.sinc(offset + 2)
    return np.sinc(offset) + (b * first + c * second) / (2 * a)
