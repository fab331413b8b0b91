"""The fast path of a global search: everything but a few bearings and one unbalance is condensed once per speed grid.

With the named bearings at a reference d0, the receptances H between bearings (b), disk (f) and probes (p) give, for
any other d = k + j Omega c, exactly:

    (I + H_bb (d - d0)) q_b = H_bf F,    q_p = H_pf F - H_pb (d - d0) q_b

so that one candidate costs a 2m x 2m solve per speed for m bearings. The reference is damped: an undamped rest of the
rotor has resonances of its own inside the grid, where H would be useless. Measured with configs/rk4.toml, 84 speeds,
one bearing, one thread: 45 us for one candidate, 4 to 6 us each in a population of 200.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rotorrig.sims.rotor.assembly import RotorModel, with_bearing
from rotorrig.sims.rotor.disk import unbalance_direction
from rotorrig.sims.rotor.harmonic import dynamic_stiffness

SOFTEST_REFERENCE = 1e4  # N/m


@dataclass(frozen=True, slots=True, kw_only=True)
class Receptance:
    """Receptances over a speed grid [m/N], the named bearings at their reference; x and y of each bearing in turn."""

    omega: NDArray[np.float64]  # (speed,) rad/s
    reference: complex  # N/m, d0
    bearing_bearing: NDArray[np.complex128]  # (2m, 2m, speed)
    bearing_force: NDArray[np.complex128]  # (2m, speed), times Omega^2
    probe_bearing: NDArray[np.complex128]  # (probe, 2m, speed)
    probe_force: NDArray[np.complex128]  # (probe, speed), times Omega^2

    def response(
        self, kxx: ArrayLike, kyy: ArrayLike, cxx: ArrayLike, cyy: ArrayLike, u: ArrayLike
    ) -> NDArray[np.complex128]:
        """Return the 1X amplitudes at the probes, (..., speed, probe) m, 0-peak.

        The arguments [N/m, N s/m, kg m] broadcast: numbers for one candidate, (n,) for a population. All named
        bearings share them. `u` may be complex: U e^{j phi}.
        """
        kxx, kyy, cxx, cyy, u = (np.asarray(value)[..., None] for value in (kxx, kyy, cxx, cyy, u))
        speed = 1j * self.omega
        change = (kxx - self.reference + cxx * speed, kyy - self.reference + cyy * speed)
        reaction = [change[i % 2] * q for i, q in enumerate(self._bearing_motion(change))]
        leading = max(reaction[0].ndim, u.ndim) - 1
        aligned = (slice(None), *(None,) * leading)  # (probe, 1.., speed) against (.., speed)
        seen = self.probe_force[aligned] - sum(
            self.probe_bearing[:, i][aligned] * force for i, force in enumerate(reaction)
        )
        return np.moveaxis(seen * u, 0, -1)  # speeds innermost until here: long inner loops

    def _bearing_motion(self, change: tuple[NDArray[np.complex128], ...]) -> list[NDArray[np.complex128]]:
        """Solve (I + H_bb (d - d0)) q_b = H_bf by Gauss elimination, all speeds and candidates in step."""
        size = len(self.bearing_bearing)
        A = [[self.bearing_bearing[i, j] * change[j % 2] for j in range(size)] for i in range(size)]
        q = list(self.bearing_force)
        for pivot in range(size):
            A[pivot][pivot] = A[pivot][pivot] + 1
            for row in range(pivot + 1, size):
                factor = A[row][pivot] / A[pivot][pivot]
                for column in range(pivot + 1, size):
                    A[row][column] = A[row][column] - factor * A[pivot][column]  # not in place: shapes may grow
                q[row] = q[row] - factor * q[pivot]
        for row in reversed(range(size)):
            for column in range(row + 1, size):
                q[row] = q[row] - A[row][column] * q[column]
            q[row] = q[row] / A[row][row]
        return q


def condense(model: RotorModel, omega: ArrayLike, *, bearings: Sequence[str], disk: str) -> Receptance:
    """Return the receptances of `model` for changing `bearings` and an unbalance on `disk`, at speeds `omega`.

    The cross coefficients of the named bearings are set to zero. Raises ValueError on an unknown name or no bearing.
    """
    if not bearings:
        raise ValueError("bearings is empty, want the names of those that change")
    omega = np.atleast_1d(np.asarray(omega, dtype=float))
    attached = [model.bearing(name) for name in bearings]
    stiffness = max(SOFTEST_REFERENCE, *(float(b.K.diagonal().max()) for b in attached))
    reference = stiffness * (1 + 1j)
    rows = np.vstack([b.rows for b in attached])
    direction = unbalance_direction(model.disk(disk), model.rotation)

    bare = with_bearing(model, bearings, np.zeros((2, 2)), np.zeros((2, 2)))
    loads = np.column_stack([rows.T, direction])  # (dof, 2m + 1)
    response = np.empty((len(omega), model.dof, loads.shape[1]), dtype=complex)
    for i, speed in enumerate(omega):
        Z = dynamic_stiffness(bare, speed)[0] + reference * (rows.T @ rows)
        response[i] = np.linalg.solve(Z, loads)
    at_bearings = np.moveaxis(rows @ response, 0, -1)  # (2m, 2m + 1, speed)
    at_probes = np.moveaxis(model.probes @ response, 0, -1)
    return Receptance(
        omega=omega,
        reference=reference,
        bearing_bearing=np.ascontiguousarray(at_bearings[:, :-1]),
        bearing_force=at_bearings[:, -1] * omega**2,
        probe_bearing=np.ascontiguousarray(at_probes[:, :-1]),
        probe_force=at_probes[:, -1] * omega**2,
    )
