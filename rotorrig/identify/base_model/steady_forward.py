"""`Steady`: what a search asks of the model, the steady 1X response of one candidate and its derivatives.

Candidates are points of the unit cube over the coefficients of a `Space`, each on its own scale. Modulus and density
stay at the nameplate's values: the receptances are condensed once, and a refinement frees them.
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.base_model.settings import BASE_MODEL
from rotorrig.identify.base_model.unknowns import Space
from rotorrig.rig.config import RigConfig
from rotorrig.sims.rotor.model import assemble, unbalance_direction
from rotorrig.sims.rotor.steady import Receptance, ReceptanceDerivatives, condense_groups

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

_FIELDS = {
    "k": ReceptanceDerivatives._fields.index("by_stiffness"),
    "c": ReceptanceDerivatives._fields.index("by_damping"),
}
_END = 1e-12  # of the unit interval: mobility is nil or infinite there


class Steady:
    """Responses to unit unbalance in each plane, over the speeds of a receptance."""

    def __init__(self, receptance: Receptance, space: Space, *, soft: float) -> None:
        """`soft` [N/m] is a stiffness to which the rotor is neither free nor held; see `starts`."""
        self.receptance = receptance
        self.space = space
        self.dim = len(space.groups) * len(space.coefficients)
        self._soft = soft
        names = space.coefficients * len(space.groups)
        self._stiffness = np.array([name[0] == "k" for name in names])
        self._places = [  # of each coefficient: field of ReceptanceDerivatives, group, row and column
            (_FIELDS[name[0]], i // len(space.coefficients), "xy".index(name[1]), "xy".index(name[2]))
            for i, name in enumerate(names)
        ]
        self._linear = np.stack(space.matrices(np.eye(len(space))), axis=1).reshape(len(space), -1)
        self._low, high = space.working_bounds[: self.dim].T
        self._width = high - self._low
        self._either_sign = np.array([unknown.low < 0 for unknown in space.unknowns[: self.dim]])
        self._fixed = space.nameplate[self.dim :]  # modulus and density
        self._fixed_working = space.to_working(space.nameplate)[self.dim :]
        self._units = np.eye(receptance.loads)

    @classmethod
    def of(cls, rig: RigConfig, omega: Real, space: Space, *, planes: Sequence[str], probes: Sequence[str]) -> "Steady":
        """Condense the rig's rotor at the speeds [rad/s], for unbalance in `planes`, seen by `probes`."""
        seen = rig.model_copy(update={"probes": tuple(rig.probe(name) for name in probes)})
        model = assemble(seen, max_element=BASE_MODEL.element)
        patterns = [unbalance_direction(model.plane(name), model.rotation) for name in planes]
        forces = omega[:, None, None] ** 2 * np.stack(patterns, axis=-1)
        receptance = condense_groups(model, omega, groups=space.groups, forces=forces)
        return cls(receptance, space, soft=shaft_stiffness(rig))

    def __call__(self, u: Real) -> tuple[Complex, Complex]:
        """Return the responses at `u`, (plane, speed, probe) m per kg m, and d/du, (dim, plane, speed, probe)."""
        values = self.values(u)
        K, C = (values @ self._linear).reshape(2, -1, 2, 2)  # as `Space.matrices`, in a tenth of the time
        slopes = (self.space.slopes(values)[: self.dim] * self._width)[:, None, None]
        loads, speeds, probes = len(self._units), len(self.receptance.omega), self.receptance.probes
        z = np.empty((loads, speeds, probes), dtype=complex)
        by_u = np.empty((self.dim, loads, speeds, probes), dtype=complex)
        for i, unit in enumerate(self._units):
            answer = self.receptance.response_and_derivatives(K, C, unit)
            z[i] = answer.z
            for n, (by, group, row, column) in enumerate(self._places):
                np.multiply(slopes[n], answer[by][group, row, column], out=by_u[n, i])
        return z, by_u

    def responses(self, u: Real) -> Complex:
        """Return the responses alone of candidates (candidate, dim), (candidate, plane, speed, probe) m per kg m."""
        K, C = self.space.matrices(self.values(u))
        return self.receptance.general_response(K[:, None], C[:, None], self._units)

    def values(self, u: Real) -> Real:
        """Return the unknowns of the space in SI, (..., unknown); modulus and density as the nameplate says."""
        working = np.empty((*u.shape[:-1], len(self.space)))
        working[..., : self.dim] = self._low + u * self._width
        working[..., self.dim :] = self._fixed_working
        return self.space.from_working(working)

    def starts(self, points: Real) -> Real:
        """Return where to begin a search, (n, dim) of the cube, for points spread evenly over it.

        Uniform in mobility, k / (k + k0): a rotor on bearings far softer or stiffer than itself behaves as a free or a
        held one, and a search from there has nothing to follow. Likewise c / (c + c0) with c0 = k0 / Omega, and cross
        coefficients of either sign.
        """
        typical = np.where(self._stiffness, self._soft, self._soft / float(np.median(self.receptance.omega)))
        signed = np.where(self._either_sign, 2 * points - 1, points)
        values = np.clip(typical * signed / np.maximum(1 - np.abs(signed), _END), *self.space.bounds[: self.dim].T)
        rest = np.broadcast_to(self._fixed, (len(points), len(self._fixed)))
        working = self.space.to_working(np.hstack([values, rest]))[:, : self.dim]
        return np.clip((working - self._low) / self._width, 0.0, 1.0)


def shaft_stiffness(rig: RigConfig) -> float:
    """Return k0 = 48 E I / L^3 [N/m] of a shaft, the stiffness of its middle between simple supports.

    Of a stepped one that of the uniform shaft with the same mean flexibility.
    """
    tubes = rig.shaft.tubes
    flexibility = sum(
        t.length / (t.youngs_modulus * math.pi / 64 * (t.diameter**4 - t.inner_diameter**4)) for t in tubes
    )
    return 48 / (flexibility * rig.shaft.length**2)
