"""Jacobian of the vectors with respect to every candidate effect, at zero amplitude.

At zero amplitude each candidate acts alone, by one of its methods, and those of one kind share one sweep: forces
are columns of it, changes of matrices are directions, and what happens at the probes needs none.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.base_model import Reals
from rotorrig.identify.causes.settings import SELECTION
from rotorrig.identify.extended_model import ExtendedModel, ExtendedProblem, Moving, Recording, halved_loads
from rotorrig.sims.effects import Effect, Parameter
from rotorrig.sims.rotor.model import Direction, Load, RotorModel, finite_difference

Complex = NDArray[np.complex128]


def score_columns(problem: ExtendedProblem, p: Reals, candidates: Sequence[Effect]) -> list[Reals]:
    """Return for each candidate d whitened residual / d its unknowns, in their sizes, (value + prior, unknown).

    Beside the effects of `problem`, at its fit `p`.
    """
    if not candidates:
        return []
    wide = problem.model.seeing({name: z for effect in candidates for name, z in effect.places.items()})
    moving = wide.moving(p)
    steps = [step for effect in candidates for step in _steps(effect, moving.model)]
    parts = [_of_recording(wide, recording, p, moving, steps) for recording in wide.recordings]
    whole = np.concatenate([*parts, np.zeros((len(problem.parameters.priors), len(steps)))])
    ends = np.cumsum([len(effect.parameters) for effect in candidates])
    return [whole[:, end - len(effect.parameters) : end] for effect, end in zip(candidates, ends, strict=True)]


@dataclass(frozen=True, slots=True, kw_only=True)
class _Step:
    """A small step of one unknown of a candidate, and what that makes of the rotor and its loads."""

    effect: Effect
    theta: dict[str, float]
    h: float  # the step in sizes
    loads: tuple[Load, ...]
    direction: Direction | None

    def acts_in(self, recording: Recording) -> bool:
        """Say whether the candidate may act there."""
        return self.effect.recording in (None, recording.number)


def _steps(effect: Effect, model: RotorModel) -> Iterator[_Step]:
    """Yield the step of each unknown; those that change the number of coordinates have no direction."""
    for q in effect.parameters:
        theta = _at_small_step(effect, q)
        h = (theta[q.name] - q.at_zero) / q.size
        there = effect.change_matrices(model, theta) if "matrices" in effect.acts_on else model
        yield _Step(
            effect=effect,
            theta=theta,
            h=h,
            loads=effect.loads(model, theta) if "loads" in effect.acts_on else (),
            direction=finite_difference(model, there, h) if there is not model and there.dof == model.dof else None,
        )


def _at_small_step(effect: Effect, q: Parameter) -> dict[str, float]:
    """Return the effect's unknowns at zero amplitude but for a small step of one, within its bounds."""
    step = SELECTION.step * q.size
    if q.low < q.high and q.at_zero + step > q.high:
        step = -step
    return effect.at_zero | {q.name: q.at_zero + step}


def _of_recording(
    model: ExtendedModel, recording: Recording, p: Reals, moving: Moving, steps: Sequence[_Step]
) -> Reals:
    """Return the columns of all steps in one recording, (value, step)."""
    stacked: list[Reals] = []
    for order, measured in recording.measured.items():
        columns = np.zeros((*measured.z.shape, len(steps)), complex)
        _by_loads(model, recording, p, moving, steps, order, columns)
        if order == 1:
            motion = model.motions(recording, p, moving)[order]
            _by_matrices(model, recording, p, moving, steps, columns)
            first, first_changes = model.probes.of_motion(p, motion, order=1), columns.copy()
        else:
            motion = model.motion_of(recording, p, moving, order=order)
        columns += model.probes.bent_changes(p, first, first_changes, order)
        z = model.probes.of_motion(p, motion, order=order) + model.probes.bent(p, first, order)
        _at_probes(model, recording, p, z, steps, order, columns)
        stacked.append(measured.sigmas(columns).reshape(-1, len(steps)))
    return np.concatenate(stacked)


def _by_loads(
    model: ExtendedModel,
    recording: Recording,
    p: Reals,
    moving: Moving,
    steps: Sequence[_Step],
    order: int,
    columns: Complex,
) -> None:
    acting = [
        (c, load, step.h)
        for c, step in enumerate(steps)
        if step.acts_in(recording)
        for load in step.loads
        if load.order == order
    ]
    z = responses_to(recording, moving.model, [load for _, load, _ in acting], order)
    for k, (c, _, h) in enumerate(acting):
        columns[..., c] += model.probes.linear(p, z[..., k]) / h


def responses_to(recording: Recording, model: RotorModel, loads: Sequence[Load], order: int) -> Complex:
    """Return what Recording.columns does, from the responses to as few loads as span them: no more than coordinates."""
    z = np.zeros((len(recording.rows) + 1, len(model.probes), len(loads)), complex)
    kinds = [(load.law, recording.begins(load)) for load in loads]
    for law, begins in dict.fromkeys(kinds):
        of_law = [k for k, load in enumerate(loads) if kinds[k] == (law, begins) and load.pattern.any()]
        if not of_law or begins == math.inf:
            continue
        patterns = np.stack([loads[k].pattern for k in of_law], axis=-1)
        size = np.linalg.norm(patterns, axis=0)
        basis, share, _ = np.linalg.svd(patterns / size, full_matrices=False)
        basis = basis[:, share > SELECTION.spanned * share[0]]
        units = [Load(pattern=pattern, law=law, order=order, since=loads[of_law[0]].since) for pattern in basis.T]
        z[..., of_law] = recording.columns(model, units, order=order) @ (basis.conj().T @ patterns)
    return z


def _by_matrices(
    model: ExtendedModel, recording: Recording, p: Reals, moving: Moving, steps: Sequence[_Step], columns: Complex
) -> None:
    acting = {c: step.direction for c, step in enumerate(steps) if step.direction is not None}
    for turns in (False, True):  # those of a stiffness that turns apart
        some = {c: by for c, by in acting.items() if (moving.halved or bool(np.ndim(by.T))) == turns}
        if not some:
            continue
        planes = halved_loads(moving.planes) if turns and not moving.halved else moving.planes
        amounts = model.amounts(recording, p, halved=turns)
        unit = recording.derivatives(moving.model, planes, list(some.values()), order=1).by
        for c, by in zip(some, unit, strict=True):
            columns[..., c] += model.probes.linear(p, np.einsum("rpl,rl->rp", by, amounts))


def _at_probes(
    model: ExtendedModel,
    recording: Recording,
    p: Reals,
    z: Complex,
    steps: Sequence[_Step],
    order: int,
    columns: Complex,
) -> None:
    """Take the columns through the effects of the model at the probes, which read `z`, and add the candidates' own."""
    acting = any("probes" in effect.acts_on for effect in model.effects)
    view = recording.view(order)
    for after_hum, through in ((False, model.probes.read), (True, model.probes.record)):
        seen = through(recording, p, z, order=order)
        for c in range(columns.shape[-1] if acting else 0):
            if columns[..., c].any():
                columns[..., c] = through(recording, p, z + columns[..., c], order=order) - seen
        z = seen
        for c, step in enumerate(steps):
            effect = step.effect
            if "probes" in effect.acts_on and effect.after_hum == after_hum and step.acts_in(recording):
                columns[..., c] += (
                    effect.change_readings(z, view, step.theta) - effect.change_readings(z, view, effect.at_zero)
                ) / step.h
