"""The derivatives of an extended problem's vectors by its unknowns, column by column."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.extended_parameters import MAINS, bends
from rotorrig.identify.parameters import Reals
from rotorrig.identify.recording import ORDERS, Recording
from rotorrig.sims.effects.base import Effect

if TYPE_CHECKING:
    from rotorrig.identify.extended import ExtendedProblem, Moving

Complex = NDArray[np.complex128]
Index = NDArray[np.intp]

Changes = dict[int, list[dict[int, Complex]]]  # unknown -> per recording: order -> (row + 1, probe)

STEP = 1e-4  # of an effect's size
STEP_UNDER_LAWS = 1e-3  # of an unknown in working coordinates, where a march settles to 1e-6


def columns(problem: ExtendedProblem, p: Reals, free: Index) -> Reals:
    """Return d whitened vectors / d p of the columns `free`, (figure, column): recordings, orders, rows, probes."""
    moving = problem.moving(p)
    by_difference = [i for i in free if _differenced(problem, p, moving, int(i))]
    added: Changes = {}
    if problem.by_laws is not None:
        by_difference = _differenced_anyway(problem, p, moving, by_difference)
        added = {i: change for i, change in problem.by_laws.items() if i in free}
    differences = _differences(problem, p, by_difference, under_laws=bool(moving.laws))
    parts = []
    for n, recording in enumerate(problem.recordings):
        found = _exact(problem, recording, p, free, moving)
        for order, measured in recording.measured.items():
            d = found[order]
            for i, change in differences.items():
                if order in change[n]:
                    d[..., np.searchsorted(free, i)] = change[n][order]
            for i, change in added.items():
                d[..., np.searchsorted(free, i)] += change[n].get(order, 0)
            sigmas = measured.sigmas(d)
            parts.append(sigmas.reshape(-1, len(free)))
    return np.concatenate(parts)


def added_by_laws(problem: ExtendedProblem, p: Reals, free: Index) -> Changes:
    """Return what force laws add to the columns `free` that are exact without them: the differences less those."""
    moving = problem.moving(p)
    by_difference = [int(i) for i in free if _differenced(problem, p, moving, int(i))]
    anyway = _differenced_anyway(problem, p, moving, by_difference)
    which = np.array([i for i in by_difference if i not in anyway])
    differences = _differences(problem, p, list(which), under_laws=True)
    linear = [_exact(problem, recording, p, which, moving) for recording in problem.recordings]
    return {
        i: [{n: z - without[n][..., k] for n, z in part.items()} for part, without in zip(change, linear, strict=True)]
        for k, (i, change) in enumerate(differences.items())
    }


def acts_on_probes(effect: Effect) -> bool:
    """Say whether an effect changes what the probes make of a motion."""
    return type(effect).seen is not Effect.seen


def on_probes_alone(effect: Effect) -> bool:
    """Say whether an effect leaves the motion as it is."""
    kind = type(effect)
    return kind.changed is Effect.changed and kind.loads is Effect.loads and kind.laws is Effect.laws


def by_matrices_alone(effect: Effect) -> bool:
    """Say whether an effect changes matrices and nothing else, and so has exact derivatives."""
    kind = type(effect)
    return (
        kind.changed is not Effect.changed
        and kind.loads is Effect.loads
        and kind.laws is Effect.laws
        and kind.seen is Effect.seen
    )


def _differenced(problem: ExtendedProblem, p: Reals, moving: Moving, i: int) -> bool:
    """Say whether column `i` is taken as a difference of the whole prediction."""
    names = problem.parameters
    of_motion = (
        i < names.base.structural.stop
        or names.base.unbalance.start <= i < names.base.unbalance.stop
        or i == names.keyphasor
    )
    if moving.laws and of_motion:
        return True
    if i < names.own.start:
        return False
    effect = next(e for e, part in zip(problem.effects, names.theta, strict=True) if part.start <= i < part.stop)
    if on_probes_alone(effect):
        return False
    if by_matrices_alone(effect) and not moving.laws:
        return problem.resized(p, i)
    return bool(moving.laws) or not effect.linear or acts_on_probes(effect)


def _differenced_anyway(problem: ExtendedProblem, p: Reals, moving: Moving, which: list[int]) -> list[int]:
    """Return those of the columns that are differences without force laws too."""
    without = replace(moving, laws=())
    return [i for i in which if _of_laws(problem, i) or _differenced(problem, p, without, i)]


def _of_laws(problem: ExtendedProblem, i: int) -> bool:
    """Say whether unknown `i` is that of a force law."""
    parts = zip(problem.effects, problem.parameters.theta, strict=True)
    return any(type(e).laws is not Effect.laws and part.start <= i < part.stop for e, part in parts)


def _differences(problem: ExtendedProblem, p: Reals, which: list[int], *, under_laws: bool) -> Changes:
    """Return (prediction(p + h e_i) - prediction(p)) / h for every i, one-sided, within the bounds."""
    if not which:
        return {}
    names, (low, high) = problem.parameters, problem.bounds
    orders = (1,) if under_laws else ORDERS
    at = problem.predict(p, orders=orders)
    amount = float(np.abs(p[names.base.unbalance]).max())
    found = {}
    for i in which:
        h = STEP_UNDER_LAWS if under_laws else STEP
        if names.base.unbalance.start <= i < names.base.unbalance.stop:
            h *= amount
        if p[i] + h > high[i] and p[i] - h >= low[i]:
            h = -h
        moved = p.copy()
        moved[i] += h
        there = problem.predict(moved, orders=orders)
        found[i] = [{n: (b[n] - a[n]) / h for n in a} for a, b in zip(at, there, strict=True)]
    return found


def _exact(problem: ExtendedProblem, recording: Recording, p: Reals, free: Index, moving: Moving) -> dict[int, Complex]:
    """Return every column that is no difference, order -> (row + 1, probe, column)."""
    rows, probes = len(recording.rows) + 1, len(recording.response.probes)
    found = {order: np.zeros((rows, probes, len(free)), complex) for order in recording.orders}
    for order in recording.orders:
        if moving.laws and order == 1:
            if problem.by_laws is not None:  # as without the laws, what they add being known
                _by_rotor(problem, recording, p, free, replace(moving, laws=()), order, found[order])
            motion = problem.motions(recording, p, moving, orders=(1,))[order]
        elif order > 1 and problem.linear_at(order):
            motion = problem.motion_of(recording, p, moving, order=order)
            _by_loads(problem, recording, p, free, moving, order, found[order])
        else:
            motion = _by_rotor(problem, recording, p, free, moving, order, found[order])
        if order == 1 or np.any(motion):
            _by_probes(problem, p, motion, free, found[order])
        _by_runout(problem, free, order, found[order])
        _by_hum(problem, recording, free, order, found[order])
        if order == 1:
            first = problem.probes.of_motion(p, motion, order=1)
        _by_curvature(problem, first, free, order, found[order])
        if any(acts_on_probes(effect) for effect in problem.effects):
            z = problem.probes.of_motion(p, motion, order=order) + problem.probes.hum(recording, p, order)
            z = z + problem.probes.bent(p, first, order)
            _through_effects(problem, recording, p, z, free, order, found[order])
    return found


def _by_rotor(
    problem: ExtendedProblem,
    recording: Recording,
    p: Reals,
    free: Index,
    moving: Moving,
    order: int,
    found: Complex,
) -> Complex:
    """Fill in the columns by structure, unbalance and linear effects; return the motion, (row + 1, 2 probe)."""
    base, planes = problem.parameters.base, list(moving.planes) if order == 1 else []
    loads = [*planes, *moving.loads(recording, order)]
    rows = len(recording.rows) + 1
    amounts = np.ones((rows, len(loads)), complex)
    if order == 1:
        amounts[:, : len(planes)] = problem.amounts(recording, p)
    if not loads:
        motion = np.zeros((rows, len(moving.model.probes)), complex)
    structural = _structural(problem, p, free) if order == 1 else free[:0]  # at 2X and 3X only amounts count
    if loads and len(structural):
        directions = problem.directions(p, moving.model, structural)
        unit, by = recording.derivatives(moving.model, loads, directions, order=order)
        for k, i in enumerate(structural):
            d = np.einsum("rpl,rl->rp", by[k], amounts)
            found[..., np.searchsorted(free, i)] = problem.probes.linear(p, d)
    elif loads:
        unit = recording.columns(moving.model, loads, order=order)
    if loads:
        motion = np.einsum("rpl,rl->rp", unit, amounts)
    if order == 1:
        sought = base.space.planes
        for i in free[(free >= base.unbalance.start) & (free < base.unbalance.stop)]:
            plane, part = divmod(int(i) - base.unbalance.start, 2)
            column = unit[..., problem.planes.index(sought[plane])] * (1j if part else 1)
            found[..., np.searchsorted(free, i)] = problem.probes.linear(p, column)
        if problem.parameters.keyphasor in free:
            turned = [1j * trial for trial in problem.trials(recording, p).values()]
            d = np.einsum("rpl,rl->rp", unit[..., : len(planes)], np.stack(turned, axis=-1))
            found[..., np.searchsorted(free, problem.parameters.keyphasor)] = problem.probes.linear(p, d)
    if not moving.laws:
        _by_loads(problem, recording, p, free, moving, order, found)
    return motion


def _structural(problem: ExtendedProblem, p: Reals, free: Index) -> Index:
    """Return the unknowns that change matrices: of the base, and of effects that do nothing else."""
    names = problem.parameters
    own = [
        i
        for effect, part in zip(problem.effects, names.theta, strict=True)
        if by_matrices_alone(effect)
        for i in range(part.start, part.stop)
        if i in free and not problem.resized(p, i)
    ]
    return free[(free < names.base.structural.stop) | np.isin(free, own)]


def _by_loads(
    problem: ExtendedProblem, recording: Recording, p: Reals, free: Index, moving: Moving, order: int, found: Complex
) -> None:
    """Fill in the columns by the loads of linear effects; those of effects on the probes too are differences."""
    names = problem.parameters
    mine = [
        i
        for effect, part in zip(problem.effects, names.theta, strict=True)
        if effect.linear and not acts_on_probes(effect)
        for i in range(part.start, part.stop)
        if i in free
    ]
    if not mine:
        return
    units = problem.unit_columns(recording, p, moving, order)
    for i in mine:
        found[..., np.searchsorted(free, i)] = problem.probes.linear(p, units[..., i - names.own.start])


def _by_probes(problem: ExtendedProblem, p: Reals, motion: Complex, free: Index, found: Complex) -> None:
    """Fill in the columns by gain and angle error."""
    base = problem.parameters.base
    gain, cos, sin = problem.probes.figures(p)
    n = len(gain)
    along, across = motion[:, :n], motion[:, n:]
    for part, d in (
        (base.gain, cos * along + sin * across),
        (base.angle, gain * (cos * across - sin * along)),
    ):
        for i in free[(free >= part.start) & (free < part.stop)]:
            k = int(i) - part.start
            found[:, k, np.searchsorted(free, i)] = d[:, k]


def _by_runout(problem: ExtendedProblem, free: Index, order: int, found: Complex) -> None:
    part = problem.parameters.runouts[order]
    for i in free[(free >= part.start) & (free < part.stop)]:
        probe, imaginary = divmod(int(i) - part.start, 2)
        found[:, probe, np.searchsorted(free, i)] = 1j if imaginary else 1.0


def _by_hum(problem: ExtendedProblem, recording: Recording, free: Index, order: int, found: Complex) -> None:
    part = problem.parameters.hums
    own = part.start + 2 * len(MAINS) * recording.number
    for i in free[(free >= own) & (free < own + 2 * len(MAINS))]:
        frequency, imaginary = divmod(int(i) - own, 2)
        found[..., np.searchsorted(free, i)] = (recording.hum[order][:, frequency] * (1j if imaginary else 1))[:, None]


def _by_curvature(problem: ExtendedProblem, first: Complex, free: Index, order: int, found: Complex) -> None:
    names = problem.parameters
    for part, unit in ((names.odd, (1.0, 0.0)), (names.even, (0.0, 1.0))):
        if not np.any((free >= part.start) & (free < part.stop)):
            continue
        d = bends(first, order, odd=unit[0], even=unit[1])
        for i in free[(free >= part.start) & (free < part.stop)]:
            k = int(i) - part.start
            found[:, k, np.searchsorted(free, i)] = d[:, k]


def _through_effects(
    problem: ExtendedProblem, recording: Recording, p: Reals, z: Complex, free: Index, order: int, found: Complex
) -> None:
    """Take columns of what the probes read through the effects behind them; fill in those by these effects."""
    names = problem.parameters
    before = problem.probes.through_effects(recording, p, z, order=order)
    for k in range(found.shape[-1]):
        if found[..., k].any():  # what an effect does there is linear in the vectors, but for a constant
            found[..., k] = problem.probes.through_effects(recording, p, z + found[..., k], order=order) - before
    for effect, part in zip(problem.effects, names.theta, strict=True):
        if not on_probes_alone(effect) or effect.recording not in (None, recording.number):
            continue
        for i in free[(free >= part.start) & (free < part.stop)]:
            moved = p.copy()
            moved[i] += STEP
            there = problem.probes.through_effects(recording, moved, z, order=order)
            found[..., np.searchsorted(free, i)] = (there - before) / STEP
