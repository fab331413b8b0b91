"""Windows of a row, as weights of the shaft angle about its middle. Harris, Proc. IEEE 66 (1978) 51.

A Hann window lets 0.3 % of a line half an order away into a row of 8 turns, and white noise as through 1.5 / turns
orders; Blackman's, 0.09 % and as through 1.73 / turns.
"""

import numpy as np
from numpy.typing import NDArray

BLACKMAN = (0.42, 0.50, 0.08)  # zero with their slope at both ends, as Hann's (0.5, 0.5)
BLACKMAN_BANDWIDTH = 1.0 + 2 * (0.25**2 + 0.04**2) / 0.42**2  # 1.727, in 1 / turns: of white noise
HANN_BANDWIDTH = 1.5


def hann(psi: NDArray[np.float64], *, turns: float) -> NDArray[np.float64]:
    """Return the weight of angle psi [rad] from the middle of a row of so many turns; 0 with its slope at the ends."""
    return 1 + np.cos(psi / turns)


def blackman(psi: NDArray[np.float64], *, turns: float) -> NDArray[np.float64]:
    """Return the same of Blackman's window."""
    a, b, c = BLACKMAN
    return a + b * np.cos(psi / turns) + c * np.cos(2 * psi / turns)


def blackman_response(beside: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return what the window lets through at `beside` = (orders away) * turns: 1 at 0, 0 at 3, 4, 5 and so on."""
    a, b, c = BLACKMAN
    first = np.sinc(beside - 1) + np.sinc(beside + 1)
    second = np.sinc(beside - 2) + np.sinc(beside + 2)
    return np.sinc(beside) + (b * first + c * second) / (2 * a)
