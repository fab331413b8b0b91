"""The least-squares problem of one or more recordings of a rig, its model extended by effects or not.

Every fit is one of these: an identification, the base of a diagnosis, a candidate cause. Columns by the rotor's own
parameters are exact; so are those by an effect's matrices and by loads that are linear, others are differences. Under a
force law the motion is not linear in anything: its columns come from the march, force_law_jacobian.py.
"""

from collections.abc import Collection, Mapping, Sequence
from functools import partial

import numpy as np

from rotorrig.identify.base_model import BASE_MODEL, Reals, thin_rows
from rotorrig.identify.extended_model.jacobian import columns, vectors_by
from rotorrig.identify.extended_model.known_error import error_of_effects, known_error
from rotorrig.identify.extended_model.model import Complex, ExtendedModel
from rotorrig.identify.extended_model.settings import ORDERS
from rotorrig.identify.extended_model.tracked_recording import Recording
from rotorrig.identify.least_squares import (
    LEAST_SQUARES,
    NONE_FIXED,
    Index,
    LinearModel,
    Solution,
    Stop,
    Worth,
    always,
    solve,
)
from rotorrig.rig import DataError
from rotorrig.sims.effects import Effect

UNIT_UNBALANCE = 1e-6  # kg m, 1 g mm: with which amplitudes are compared first
SMALLEST_SHARE = 1e-6  # of it: none at all would have no derivatives


class ExtendedProblem:
    """Residuals of all recordings and priors over the vector of ExtendedParameters."""

    def __init__(self, model: ExtendedModel) -> None:
        """Set up to fit `model` to its recordings."""
        self.model = model
        self.recordings = model.recordings
        self.effects = model.effects
        self.parameters = model.parameters

    def on(self, recordings: Sequence[Recording]) -> "ExtendedProblem":
        """Return the same problem of other recordings or rows."""
        return ExtendedProblem(self.model.on(recordings))

    def of(self, vectors: Sequence[Mapping[int, Complex]]) -> "ExtendedProblem":
        """Return the same problem of other vectors per recording, order -> (row + 1, probe) [m], with their noise."""
        return self.on([r.instead(z) for r, z in zip(self.recordings, vectors, strict=True)])

    def expecting_error(self, p: Reals, *, pinned: bool = False, of_laws: bool = True) -> "ExtendedProblem":
        """Return the same problem with the model's own error, of its motion at `p`, in the covariance.

        For fits with nuisances `pinned` at their priors it holds, to the first order, what these do at 1X as well;
        without `of_laws` the laws of effects are taken for exact.
        """
        known = self.known_error(p, of_laws=of_laws)
        if pinned:
            which = np.array(sorted(self.parameters.pinned), dtype=np.intp)
            moved = [z * self.parameters.prior_sigma[which] for z in vectors_by(self.model, p, which)]
            known = [own | {1: np.concatenate([own[1], z], axis=-1)} for own, z in zip(known, moved, strict=True)]
        each = zip(self.recordings, self.model.predict(p, orders=(1,)), known, strict=True)
        return self.on([recording.expecting_error(z, known) for recording, z, known in each])

    def known_error(self, p: Reals, *, of_laws: bool = True) -> list[dict[int, Complex]]:
        """Return what is known of the shape of the model's own error: order -> (row + 1, probe, column) m at `p`.

        Of every recording, one standard deviation each: known_error.py.
        """
        return known_error(self.model, p, of_laws=of_laws)

    def error_of_effects(self, p: Reals) -> list[dict[int, Complex]]:
        """Return that of its effects alone, of every recording: empty where that is nothing."""
        return error_of_effects(self.model, p)

    def taken_for_exact(self) -> "ExtendedProblem":
        """Return the same problem with noise alone in the covariance."""
        if all(m.error is None for recording in self.recordings for m in recording.measured.values()):
            return self
        return self.on([r.taken_for_exact() for r in self.recordings])

    def less_error(self, figures: Reals) -> Reals:
        """Return a residual or a Jacobian of a model taken for exact as of one with an error of its own."""
        measured = [m for recording in self.recordings for m in recording.measured.values()]
        *parts, priors = np.split(figures, np.cumsum([m.whiten[..., 0].size for m in measured]))
        shrunk = (m.shrinkage(part) if m.shrinkage else part for part, m in zip(parts, measured, strict=True))
        return np.concatenate([*shrunk, priors])

    def with_wider_priors(self, nuisances: Collection[str]) -> "ExtendedProblem":
        """Return the same problem with wider priors of these nuisances."""
        return ExtendedProblem(self.model.with_wider_priors(nuisances))

    def thinned(self, p: Reals, *, count: int) -> tuple["ExtendedProblem", Index]:
        """Return the problem of `count` rows of the first recording, at 1X, and where in `p` its unknowns stand.

        The speed of each row is taken as steady: what its change does is that of the model at `p`.
        """
        whole = self.recordings[0]
        kept = thin_rows(np.arange(len(whole.rows)), count)
        problem = self.on([whole.thinned(kept)])
        index = np.array([self.parameters.names.index(name) for name in problem.parameters.names])
        (moving,) = self.on([whole]).model.predict(p, orders=(1,))
        (steady,) = problem.model.predict(p[index])
        thin = problem.recordings[0]
        z = thin.measured[1].z - (moving[1][np.append(kept, len(whole.rows))] - steady[1])
        return problem.on([thin.instead({1: z})]), index

    def extended(self, effects: Sequence[Effect]) -> "ExtendedProblem":
        """Return the problem of the same recordings with these effects instead."""
        return ExtendedProblem(self.model.extended(effects))

    @property
    def swept(self) -> bool:
        """Whether the moving speed is in the model of every recording."""
        return all(recording.swept for recording in self.recordings)

    @property
    def curved(self) -> bool:
        """Whether an effect has no first order and is begun at its starts."""
        return any(effect.needs_starts for effect in self.effects)

    @property
    def bounds(self) -> tuple[Reals, Reals]:
        """Lower and upper bounds of the parameters."""
        return self.parameters.bounds

    @property
    def size(self) -> int:
        """Number of real figures measured, and of priors."""
        return sum(m.size for r in self.recordings for m in r.measured.values()) + len(self.parameters.priors)

    def begin(self, values: Reals, own: Reals | None = None) -> Reals:
        """Return a full vector from the base's unknowns in SI, what is linear at its best.

        Effects are at nothing, or at `own`, all their unknowns in sizes.
        """
        names = self.parameters
        p = names.start(np.zeros(0))
        space = names.base.space
        p[names.base.sought] = np.clip(space.to_working(values), *space.working_bounds.T)
        if own is not None:
            p[names.own] = own
        return self.solve_linear(p, np.arange(len(p)))

    def approach(self, values: Reals, own: Reals | None = None) -> Solution:
        """Refine from `begin` as if the nameplate and the probes were exact.

        Far from the minimum a nuisance would take what the unknowns have not reached yet, and find back only slowly.
        """
        return self.solve(
            self.begin(values, own),
            fixed=self.parameters.pinned,
            tolerance=BASE_MODEL.near,
            damped=True,
        )

    def solve(
        self,
        start: Reals,
        *,
        fixed: Mapping[int, float] = NONE_FIXED,
        tolerance: float = LEAST_SQUARES.tolerance,
        share: float = 0.0,
        of_excess: bool = False,
        max_steps: int = LEAST_SQUARES.steps,
        worth: Worth = always,
        damped: bool = False,
        jacobian: Reals | None = None,
    ) -> Solution:
        """Refine by least squares within the bounds, the parameters in `fixed` held: least_squares.solve.

        `damped` is for starts far off, where full steps of a wrong model run to the bounds; force laws want it anyway.
        Responses to loads above 1X are first those of the rotor at the start; where it matters, from then on exact.
        """
        fixed = {**self.parameters.frozen, **fixed}
        units, laws = self.model.units, bool(self.model.moving(start).laws)
        units.release()
        refine = partial(
            solve,
            self,
            fixed=fixed,
            tolerance=tolerance,
            share=share,
            of_excess=of_excess,
            max_steps=max_steps,
            worth=worth,
            damped=damped or laws,
        )
        found = refine(start, jacobian=jacobian)
        if units.seen and not units.exact and found.stop is not Stop.GIVEN_UP and np.isfinite(found.chi2):
            before = self.residual(found.p)
            units.release()
            if not self.sum_squares(found.p, less=before) <= tolerance:
                units.exact = True
                found = refine(min((found.p, start), key=self.sum_squares))  # at the one the motion may be unbounded
        return found

    def sum_squares(self, p: Reals, less: Reals | float = 0.0) -> float:
        """Return the sum of squares of the residual, or of what it is beyond another; infinite without a motion."""
        try:
            with np.errstate(over="ignore", invalid="ignore"):
                squared = float(np.sum((self.residual(p) - less) ** 2))
        except DataError:
            return np.inf
        return squared if np.isfinite(squared) else np.inf

    def residual(self, p: Reals, *, orders: Sequence[int] = ORDERS) -> Reals:
        """Return whitened residuals, model less measured, then the priors' [sigma]; 0 at orders not asked for.

        Raises DataError where the model has no motion.
        """
        try:
            vectors = self.model.predict(p, orders=orders)
        except np.linalg.LinAlgError as error:
            raise DataError(f"the rotor has no bounded motion with these parameters ({error})") from error
        parts = []
        for recording, predicted in zip(self.recordings, vectors, strict=True):
            for order, measured in recording.measured.items():
                off = measured.off(predicted[order]) if order in predicted else np.zeros_like(measured.z)
                parts.append(measured.sigmas(off).ravel())
        return np.concatenate([*parts, self.parameters.prior_residual(p)])

    def jacobian(self, p: Reals, free: Index | None = None) -> Reals:
        """Return d residual / d p, (figure + prior, parameter), or its columns `free` alone."""
        free = np.arange(len(p)) if free is None else free
        data = columns(self.model, p, free)
        return np.concatenate([data, self.parameters.prior_jacobian()[:, free]])

    def solve_linear(self, p: Reals, free: Index) -> Reals:
        """Return `p` with unbalance, runout, hum and the amounts of linear effects among `free` at their best.

        Of amplitudes alone an unbalance of zero is scaled to its best. Raises LinAlgError where the motion is beyond
        bounds, as of an unstable rotor.
        """
        if self.model.amplitudes_alone:
            return self._scale_unbalance(p)
        linear = np.intersect1d(free, self.model.linear())
        J, r = self.jacobian(p, linear), self.residual(p)
        if not (np.all(np.abs(J) < LEAST_SQUARES.unbounded) and np.isfinite(r).all()):  # NaN is not
            raise np.linalg.LinAlgError("the motion is beyond bounds")
        out = p.copy()
        anywhere = np.full(len(linear), np.inf)
        out[linear] = LinearModel(J, r, p[linear], (-anywhere, anywhere)).best(0.0)
        return np.clip(out, *self.bounds)

    def _scale_unbalance(self, p: Reals) -> Reals:
        """Return `p` with an unbalance that suits the amplitudes, which are in proportion to it but for runout.

        One that is not zero stays as it is.
        """
        out, real = p.copy(), self.parameters.base.unbalance.start
        if out[real]:
            return out
        out[real] = UNIT_UNBALANCE
        predicted = self.model.predict(out)
        both = [
            (m.sigmas(np.abs(z[order]) + 0j).ravel(), m.sigmas(m.z).ravel())
            for r, z in zip(self.recordings, predicted, strict=True)
            for order, m in r.measured.items()
        ]
        model, measured = (np.concatenate(parts) for parts in zip(*both, strict=True))
        square = float(model @ model)
        if not np.isfinite(square) or square == 0:
            raise np.linalg.LinAlgError("the motion is beyond bounds")
        out[real] *= max(float(model @ measured) / square, SMALLEST_SHARE)
        return out
