"""Orbits: what two probes at the same place along the shaft say of its path."""

import numpy as np
from numpy.typing import NDArray

from rotorrig.processing import OrderTrackedResponse, Plane


def orbit(plane: Plane, z: NDArray[np.complex128], *, points: int = 91) -> NDArray[np.float64]:
    """Return one turn (point, 2) of x and y from the 1X vectors z (2 probes,); the first point is the keyphasor edge.

    >>> rows = np.eye(2)  # probes at 0 and 90 degrees
    >>> plane = Plane(position=0.1, probes=("x", "y"), to_xy=rows)
    >>> orbit(plane, np.array([2.0, -2.0j]), points=5).round(9) + 0.0  # a forward circle, at +x at the edge
    array([[ 2.,  0.],
           [ 0.,  2.],
           [-2.,  0.],
           [ 0., -2.],
           [ 2.,  0.]])
    """
    theta = np.linspace(0.0, 2 * np.pi, points)
    readings = np.outer(z, np.exp(1j * theta)).real  # x = Re(z e^{j theta})
    return (plane.to_xy @ readings).T


def representative_rows(
    response: OrderTrackedResponse, z: NDArray[np.complex128], *, run: int, count: int = 5
) -> list[int]:
    """Return about `count` rows of a run, evenly spread in speed, with the row of the largest vector among them."""
    rows = np.flatnonzero((response.run == run) & response.usable.all(axis=1) & np.isfinite(z).all(axis=1))
    if len(rows) <= count:
        return rows.tolist()
    omega = response.omega[rows]
    wanted = np.linspace(omega.min(), omega.max(), count)
    peak = int(np.argmax(np.abs(z[rows]).max(axis=1)))
    wanted[int(np.argmin(np.abs(wanted - omega[peak])))] = omega[peak]
    nearest = {int(rows[np.argmin(np.abs(omega - w))]) for w in wanted}
    return sorted(nearest, key=lambda row: response.omega[row])
