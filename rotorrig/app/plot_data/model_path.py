"""A model's vectors between the rows of a run, so that their path is drawn as the curve it is, not as a polygon."""

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import Akima1DInterpolator

from rotorrig.app.plot_data.curves import Curve
from rotorrig.app.plot_data.thinning import MOST

STEP = 0.03  # of the largest vector: how far apart points of a path are at the most
FEWEST = 3  # rows that an interpolation needs


def model_path(curve: Curve) -> tuple[NDArray[np.float64], NDArray[np.complex128]]:
    """Return speeds [rpm] and model vectors (point,) [µm] along a run, by rising speed, with points between its rows.

    Between rows by Akima's piecewise cubic, which does not overshoot where rows crowd; a run of more than MOST rows
    needs none.
    """
    assert curve.model_amplitude is not None and curve.model_lag is not None
    z = np.asarray(curve.model_amplitude * np.exp(-1j * np.radians(curve.model_lag)), dtype=np.complex128)
    known = np.flatnonzero(np.isfinite(z) & np.isfinite(curve.rpm))
    rpm, first = np.unique(curve.rpm[known], return_index=True)
    z = z[known][first]
    if not FEWEST <= len(rpm) <= MOST:
        return rpm, z
    step = STEP * float(np.abs(z).max()) or 1.0
    pieces = np.ceil(np.abs(np.diff(z)) / step).astype(int).clip(1, MOST)
    between = [a + (b - a) * np.arange(n) / n for a, b, n in zip(rpm[:-1], rpm[1:], pieces, strict=True)]
    fine = np.append(np.concatenate(between), rpm[-1])
    xy = Akima1DInterpolator(rpm, np.stack([z.real, z.imag], axis=1))(fine)
    return fine, np.asarray(xy @ [1, 1j], dtype=np.complex128)
