"""What a refined fit frees, in order, and the priors of what the nameplate cannot know exactly.

k and c (as logarithms) and the unbalance vector are what is sought. Modulus, disk mass, the other bearings, probe
gain and angle are nuisances with the config's priors, and each probe has its runout. Freed only later, each of them
would be "discovered" in healthy data: +1 % on E alone is a false alarm every time.
"""

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.space import NAMES
from rotorrig.rig.description import RigConfig

Reals = NDArray[np.float64]


class Parameters:
    """Names and slices of the vector `p`, and its priors; made for one rig and the probes of one response."""

    def __init__(self, rig: RigConfig, probes: tuple[str, ...]) -> None:
        """Lay out the vector."""
        n = len(probes)
        sought = rig.identify.bearings if rig.identify else ()
        self.others = tuple(b.name for b in rig.bearings if b.name not in sought and not b.rigid)
        self.names = (
            *NAMES[:4],
            *("E", "disk mass", *(f"bearing {name} {axis}" for name in self.others for axis in "xy")),
            *(f"gain {name}" for name in probes),
            *(f"angle {name}" for name in probes),
            *("u re", "u im"),
            *(f"runout {name} {part}" for name in probes for part in ("re", "im")),
        )
        ends = np.cumsum([4, 2 + 2 * len(self.others), n, n, 2, 2 * n])
        starts = [0, *ends[:-1]]
        self.bearing, self.nameplate, self.gain, self.angle, self.unbalance, self.runout = (
            slice(int(a), int(b)) for a, b in zip(starts, ends, strict=True)
        )
        self.structural = slice(0, self.nameplate.stop)  # what the response depends on nonlinearly
        self.linear = slice(self.unbalance.start, self.runout.stop)
        prior = rig.prior
        self._sigma = np.full(len(self.names), np.inf)
        self._sigma[self.nameplate] = [prior.youngs_modulus, prior.disk_mass] + [prior.bearing] * 2 * len(self.others)
        self._sigma[self.gain] = prior.probe_gain
        self._sigma[self.angle] = prior.probe_angle
        self._sigma[self.runout] = prior.runout
        self.priors = np.flatnonzero(np.isfinite(self._sigma))

    def __len__(self) -> int:
        """Return the number of parameters."""
        return len(self.names)

    def bounds(self, box: Reals) -> tuple[Reals, Reals]:
        """Return lower and upper bounds of `p` from those of k and c, (4, 2) logarithms."""
        low, high = np.full(len(self), -np.inf), np.full(len(self), np.inf)
        low[self.bearing], high[self.bearing] = box.T
        low[self.nameplate], high[self.nameplate] = -0.3, 0.3  # beyond that the nameplate is not of this rig
        return low, high

    def prior_residual(self, p: Reals) -> Reals:
        """Return the nuisances in units of their priors' sigmas."""
        return p[self.priors] / self._sigma[self.priors]

    def prior_jacobian(self) -> Reals:
        """Return d prior_residual / d p."""
        rows = np.zeros((len(self.priors), len(self)))
        rows[np.arange(len(rows)), self.priors] = 1 / self._sigma[self.priors]
        return rows
