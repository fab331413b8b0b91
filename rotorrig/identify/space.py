"""What is identified and within which bounds: five parameters in SI, each searched on a logarithmic scale.

Chapter 8.2, eq. (21) and the side constraints below it: stiffness, damping and unbalance span decades, so that a
step means a ratio. In linear coordinates a hundredth of the box would hold nine tenths of the decades.
"""

import numpy as np
from numpy.typing import NDArray

from rotorrig.rig.description import Identify

NAMES = ("kxx", "kyy", "cxx", "cyy", "u")
UNITS = ("N/m", "N/m", "N s/m", "N s/m", "kg m")


def bounds(identify: Identify) -> NDArray[np.float64]:
    """Return lower and upper bounds of kxx, kyy, cxx, cyy, u, (5, 2) in SI."""
    return np.array([identify.k_bounds] * 2 + [identify.c_bounds] * 2 + [identify.u_bounds])
