"""What a little of each cause would do to the vectors of all recordings: one linearisation for a whole catalogue.

Every candidate stands at nothing, so each is told by its own verb alone, and those of one kind share one sweep: forces
are columns of it, changes of matrices are directions, and what happens at the probes needs none.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.extended import ExtendedProblem, Moving
from rotorrig.identify.extended_jacobian import acts_on_probes
from rotorrig.identify.parameters import Reals
from rotorrig.identify.recording import Recording
from rotorrig.sims.effects.base import Effect, Parameter
from rotorrig.sims.rotor.assembly import RotorModel
from rotorrig.sims.rotor.directions import between
from rotorrig.sims.rotor.loads import Load

Complex = NDArray[np.complex128]

STEP = 1e-4  # of an unknown's size
SPANNED = 1e-12  # of the loads' greatest singular value: less is rounding


def score_columns(problem: ExtendedProblem, p: Reals, candidates: Sequence[Effect]) -> list[Reals]:
    """Return for each candidate d whitened residual / d its unknowns, in their sizes, (figure + prior, unknown).

    Beside the effects of `problem`, at its fit `p`.
    """
    if not candidates:
        return []
    wide = problem.seeing({name: z for effect in candidates for name, z in effect.places.items()})
    moving = wide.moving(p)
    parts = [_of_recording(wide, recording, p, moving, candidates) for recording in wide.recordings]
    priors = len(problem.parameters.priors)
    return [
        np.concatenate([*(part[i] for part in parts), np.zeros((priors, len(effect.parameters)))])
        for i, effect in enumerate(candidates)
    ]


def _of_recording(
    problem: ExtendedProblem, recording: Recording, p: Reals, moving: Moving, candidates: Sequence[Effect]
) -> list[Reals]:
    count = sum(len(effect.parameters) for effect in candidates)
    stacked: list[Reals] = []
    for order, measured in recording.measured.items():
        motion = problem.motions(recording, p, moving)[order] if order == 1 else None
        found = np.zeros((*measured.z.shape, count), complex)
        _by_loads(problem, recording, p, moving, candidates, order, found)
        if order == 1:
            _by_matrices(problem, recording, p, moving, candidates, found)
        if motion is None:
            motion = problem.motion_of(recording, p, moving, order=order)
        _at_probes(problem, recording, p, motion, candidates, order, found)
        sigmas = measured.sigmas(found)
        stacked.append(sigmas.reshape(-1, count))
    whole = np.concatenate(stacked)
    ends = np.cumsum([len(effect.parameters) for effect in candidates])
    return [whole[:, end - len(effect.parameters) : end] for effect, end in zip(candidates, ends, strict=True)]


def _stepped(effect: Effect, q: Parameter) -> dict[str, float]:
    """Return the effect's unknowns at nothing but for a step of one, towards where it may go."""
    step = STEP * q.size if q.nothing + STEP * q.size <= q.high else -STEP * q.size
    return effect.at_nothing | {q.name: q.nothing + step}


def _steps(effect: Effect) -> list[tuple[Parameter, dict[str, float], float]]:
    """Return each unknown, the effect stepped along it and the step in sizes."""
    found = []
    for q in effect.parameters:
        theta = _stepped(effect, q) if q.low < q.high else effect.at_nothing | {q.name: q.nothing + STEP * q.size}
        found.append((q, theta, (theta[q.name] - q.nothing) / q.size))
    return found


def _by_loads(
    problem: ExtendedProblem,
    recording: Recording,
    p: Reals,
    moving: Moving,
    candidates: Sequence[Effect],
    order: int,
    found: Complex,
) -> None:
    loads: list[Load] = []
    column: list[int] = []
    share: list[float] = []
    c = 0
    for effect in candidates:
        for _, theta, h in _steps(effect):
            if type(effect).loads is not Effect.loads and effect.recording in (None, recording.number):
                mine = [load for load in effect.loads(moving.model, theta) if load.order == order]
                loads, column, share = loads + mine, column + [c] * len(mine), share + [1 / h] * len(mine)
            c += 1
    z = _responses(recording, moving.model, loads, order)
    for k, (c, by) in enumerate(zip(column, share, strict=True)):
        found[..., c] += by * problem.probes.linear(p, z[..., k])


def _responses(recording: Recording, model: RotorModel, loads: Sequence[Load], order: int) -> Complex:
    """Return what Recording.columns does, from the responses to as few loads as span them: no more than coordinates."""
    found = np.zeros((len(recording.rows) + 1, len(model.probes), len(loads)), complex)
    for law, since in dict.fromkeys((load.law, load.since) for load in loads):
        of_law = [k for k, load in enumerate(loads) if (load.law, load.since) == (law, since) and load.pattern.any()]
        if not of_law:
            continue
        patterns = np.stack([loads[k].pattern for k in of_law], axis=-1)
        size = np.linalg.norm(patterns, axis=0)
        basis, share, _ = np.linalg.svd(patterns / size, full_matrices=False)
        basis = basis[:, share > SPANNED * share[0]]
        units = [Load(pattern=pattern, law=law, order=order, since=since) for pattern in basis.T]
        found[..., of_law] = recording.columns(model, units, order=order) @ (basis.conj().T @ patterns)
    return found


def _by_matrices(
    problem: ExtendedProblem,
    recording: Recording,
    p: Reals,
    moving: Moving,
    candidates: Sequence[Effect],
    found: Complex,
) -> None:
    directions, column = [], []
    c = 0
    for effect in candidates:
        for _, theta, h in _steps(effect):
            if type(effect).changed is not Effect.changed:
                there = effect.changed(moving.model, theta)
                if there.dof == moving.model.dof:
                    directions.append(between(moving.model, there, h))
                    column.append(c)
            c += 1
    if not directions:
        return
    amounts = problem.amounts(recording, p)
    unit = recording.derivatives(moving.model, moving.planes, directions, order=1).by
    for k, c in enumerate(column):
        found[..., c] += problem.probes.linear(p, np.einsum("rpl,rl->rp", unit[k], amounts))


def _at_probes(
    problem: ExtendedProblem,
    recording: Recording,
    p: Reals,
    motion: Complex,
    candidates: Sequence[Effect],
    order: int,
    found: Complex,
) -> None:
    z = problem.probes.of_motion(p, motion, order=order) + problem.probes.hum(recording, p, order)
    if any(acts_on_probes(effect) for effect in problem.effects):
        seen = problem.probes.through_effects(recording, p, z, order=order)
        for c in range(found.shape[-1]):
            if found[..., c].any():
                found[..., c] = problem.probes.through_effects(recording, p, z + found[..., c], order=order) - seen
        z = seen
    view = recording.view(order)
    c = 0
    for effect in candidates:
        for _, theta, h in _steps(effect):
            if acts_on_probes(effect) and effect.recording in (None, recording.number):
                found[..., c] += (effect.seen(z, view, theta) - effect.seen(z, view, effect.at_nothing)) / h
            c += 1
