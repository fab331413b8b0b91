"""The unknowns of a diagnosis: those of the base model, a few more nuisances, and those of effects in their sizes.

The nuisances more than a fit of one recording at 1X has: runout at higher orders, the angle of the keyphasor's mark,
which a known trial mass shows, a little hum of the mains in every recording, and the curvature of what a probe reads.
"""

from collections.abc import Collection, Sequence

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.base_model import BASE_MODEL, Parameters, Reals
from rotorrig.identify.extended_model.mains_hum import HumLine, hum_names
from rotorrig.identify.extended_model.probe_curve import ProbeCurves
from rotorrig.identify.extended_model.settings import EXTENDED_MODEL
from rotorrig.rig.config import RigConfig
from rotorrig.sims.effects import Effect

Complex = NDArray[np.complex128]

KEYPHASOR = "keyphasor angle"  # rad, of the mark: the angle that trial masses are given from
EXACT = 1e-12  # standard deviation of what a config takes for exact, in SI or as a ratio


class ExtendedParameters:
    """Names, slices, bounds and priors of the vector `p`; effects stand last, in units of their parameters' sizes."""

    def __init__(
        self,
        rig: RigConfig,
        probes: tuple[str, ...],
        *,
        orders: Sequence[int],
        hum_lines: Sequence[HumLine],
        effects: Sequence[Effect],
        widened: Collection[str] = (),
        amplitudes_alone: bool = False,
    ) -> None:
        """Lay out the vector; nuisances in `widened` get wider priors. Raises ConfigError without [identify].

        `hum_lines` are the lines of the mains in each recording.
        With `amplitudes_alone` the unbalance is real, as its phase may be any.
        """
        self.base = Parameters(rig, probes)
        unbalance = range(self.base.unbalance.start + 1, self.base.unbalance.stop, 2)
        self._of_phase = list(unbalance) if amplitudes_alone else []
        self.effects = tuple(effects)
        self._own = [p for effect in effects for p in effect.parameters]
        runouts = [f"runout {n}X {name} {part}" for n in orders if n > 1 for name in probes for part in ("re", "im")]
        hums = hum_names(hum_lines)
        own = [f"{effect.label}: {p.name}" for effect in effects for p in effect.parameters]
        self.probe_curves = ProbeCurves(rig, probes)
        self.names = (*self.base.names, *runouts, KEYPHASOR, *hums, *self.probe_curves.names, *own)
        count, per_order = len(self.base), 2 * len(probes)
        self.runouts = {1: self.base.runout}
        for n in orders:
            if n > 1:
                self.runouts[n] = slice(count, count + per_order)
                count += per_order
        self.keyphasor = count
        self.hums = slice(count + 1, count + 1 + len(hums))
        self.hum_lines = tuple(hum_lines)
        self.curves = slice(self.hums.stop, self.hums.stop + len(self.probe_curves.names))
        count = self.curves.stop
        self.theta: list[slice] = []
        for effect in effects:
            self.theta.append(slice(count, count + len(effect.parameters)))
            count += len(effect.parameters)
        sigmas = np.concatenate(
            [
                self.base.prior_sigma,
                np.full(len(runouts), rig.prior.runout),
                [rig.prior.keyphasor_angle],
                np.full(len(hums), rig.prior.line_hum),
                self.probe_curves.prior_sigma,
                [q.prior / q.size for q in self._own],
            ]
        )
        self.stated_sigma = np.maximum(sigmas, EXACT)
        wider = [EXTENDED_MODEL.wider if name in widened else 1.0 for name in self.names]
        self.prior_sigma = self.stated_sigma * wider
        self.base.bounding_sigma = self.base.prior_sigma * wider[: len(self.base)]
        self.priors = np.flatnonzero(np.isfinite(self.prior_sigma))
        self._nothing = np.zeros(len(self.names))
        self._nothing[self.own] = [q.at_zero / q.size for q in self._own]

    def __len__(self) -> int:
        """Return the number of parameters."""
        return len(self.names)

    @property
    def linear_nuisances(self) -> set[int]:
        """Those that vectors are linear in, runout and hum: solved for in every step, they need no finding."""
        parts = (*self.runouts.values(), self.hums)
        return {i for part in parts for i in range(part.start, part.stop)}

    @property
    def pinned(self) -> dict[int, float]:
        """The nuisances that are not solved for in every step, at their priors: parameter -> value."""
        return {int(i): float(self._nothing[i]) for i in self.priors if i not in self.linear_nuisances}

    @property
    def own(self) -> slice:
        """Where those of all effects stand."""
        return slice(len(self) - len(self._own), len(self))

    @property
    def bounds(self) -> tuple[Reals, Reals]:
        """Lower and upper bounds of `p`."""
        low, high = np.full(len(self), -np.inf), np.full(len(self), np.inf)
        low[: len(self.base)], high[: len(self.base)] = self.base.bounds
        wider = EXTENDED_MODEL.fit_range
        low[self._of_phase] = high[self._of_phase] = 0.0
        low[self.own] = [(p.low * wider if p.low < 0 else p.low / wider) / p.size for p in self._own]
        high[self.own] = [(p.high * wider if p.high > 0 else p.high / wider) / p.size for p in self._own]
        return low, high

    def at_bound(self, p: Reals) -> NDArray[np.intp]:
        """Return the unknowns that are at a bound, or so near that nothing but rounding or a fit's end keeps them off.

        Near is `BASE_MODEL.at_bound` of what an unknown is measured in, or of its prior's standard deviation if less.
        """
        near = BASE_MODEL.at_bound * np.minimum(self.stated_sigma, 1.0)
        low, high = self.bounds
        return np.flatnonzero((p <= low + near) | (p >= high - near))

    @property
    def frozen(self) -> dict[int, float]:
        """The unknowns that no fit moves, as their bounds coincide or a scan finds them: parameter -> value."""
        own = {
            i: p.at_zero / p.size
            for i, p in zip(range(self.own.start, self.own.stop), self._own, strict=True)
            if p.low == p.high or p.grid_searched
        }
        return dict.fromkeys(self._of_phase, 0.0) | own

    @property
    def free(self) -> NDArray[np.intp]:
        """All others."""
        return np.setdiff1d(np.arange(len(self)), list(self.frozen))

    def start(self, base: Reals) -> Reals:
        """Return a vector with the base parameters of another one, (>= base,), and every effect at nothing."""
        p = np.zeros(len(self))
        shared = min(len(base), len(self) - len(self._own))
        p[:shared] = base[:shared]
        p[self.own] = [q.at_zero / q.size for q in self._own]
        return p

    def of_effect(self, p: Reals, i: int) -> dict[str, float]:
        """Return the unknowns of effect number `i` in SI."""
        parameters = self.effects[i].parameters
        return {q.name: float(v * q.size) for q, v in zip(parameters, p[self.theta[i]], strict=True)}

    def prior_residual(self, p: Reals) -> Reals:
        """Return the nuisances in units of their priors' sigmas."""
        return (p[self.priors] - self._nothing[self.priors]) / self.prior_sigma[self.priors]

    def prior_jacobian(self) -> Reals:
        """Return d prior_residual / d p."""
        rows = np.zeros((len(self.priors), len(self)))
        rows[np.arange(len(rows)), self.priors] = 1 / self.prior_sigma[self.priors]
        return rows
