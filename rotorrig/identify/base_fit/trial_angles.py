"""Angles of trial masses: whether the data say that they are counted otherwise than they were told.

A scale on a disk may run against the rotation, and its zero may be anywhere. What masses did change is held against
what the rotor model, fitted to the rows without them, says they would, for either sense and every offset: with a mass u
the change is e^{j offset} H u, or of conj(u). A reading that is far better than the one told is tried in a fit of all
rows, and that fit decides. The mark's own error, within `prior.keyphasor_angle`, the fit has as a nuisance; here it is
about what is beyond that.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.base_fit.base_fit import BaseProblem, KnownEffect, SearchOptions, search_and_refine
from rotorrig.identify.extended_model import KEYPHASOR, ExtendedProblem, Recording, recordings_of
from rotorrig.identify.identification import TrialAngles
from rotorrig.identify.least_squares import Solution
from rotorrig.processing import OrderTrackedResponse

Complex = NDArray[np.complex128]

UNIT = 1e-5  # kg m, of the mass whose effect is taken
FEWEST = 2  # rows without a mass, to fit a rotor to
FAR = 4.0  # standard deviations of the mark: within that the fit's own nuisance will do
BETTER = 0.5  # of the misfit of the angles as told: a reading that leaves more explains nothing; another fault may
SURE = 25.0  # of chi2, in the noise that the better reading leaves: five standard deviations
ALIKE = 16.0  # of it: two readings nearer than that are both possible
ROUNDS = 3  # in which the offset and the rotor are fitted in turn


@dataclass(frozen=True, slots=True)
class _Reading:
    """One way to count the angles: the best offset, its standard deviation [rad], and the misfit that is left."""

    reversed: bool
    offset: float
    sigma: float
    misfit: float


def judge_trial_angles(
    responses: Sequence[OrderTrackedResponse],
    effects: Sequence[KnownEffect],
    options: SearchOptions,
    *,
    told: Solution,
) -> TrialAngles | None:
    """Return how the angles of trial masses are counted if not as they are told; None if they are or nothing tells.

    `told` is the fit to all responses with the angles as told.
    """
    recordings = recordings_of(responses, orders=(1,))
    loaded = [_loaded(recording) for recording in recordings]
    bare = [r.only(~on).with_trial({}) for r, on in zip(recordings, loaded, strict=True) if (~on).sum() >= FEWEST]
    if not bare or not any(on.any() for on in loaded):
        return None
    _, problem, best = search_and_refine(BaseProblem.of(bare, effects), options)
    as_told, readings = _read_all(problem, best, recordings)
    tried = [_fit_reading(r, responses, effects, options) for r in readings if r.misfit < BETTER * as_told]
    if not tried:
        return None
    prior, left = recordings[0].rig.prior.keyphasor_angle, max(1.0, min(r.misfit for r in tried) / told.dof)
    first, *others = sorted(tried, key=lambda r: r.misfit / left + (r.offset / prior) ** 2)
    better = first.misfit < min(BETTER * told.chi2, told.chi2 - SURE * left)
    if not (better and (first.reversed or abs(first.offset) > FAR * prior)):
        return None
    return TrialAngles(
        reversed=first.reversed,
        offset=first.offset,
        sigma=first.sigma * math.sqrt(left),
        chi2_told=told.chi2,
        chi2=first.misfit,
        or_offset=next((r.offset for r in others if r.misfit - first.misfit < ALIKE * left), None),
    )


def _fit_reading(
    reading: _Reading,
    responses: Sequence[OrderTrackedResponse],
    effects: Sequence[KnownEffect],
    options: SearchOptions,
) -> _Reading:
    """Fit all responses with the angles read so and the offset to that, in turn; the misfit is then that of the fit."""
    recordings = recordings_of(responses, orders=(1,))
    for _ in range(ROUNDS):
        counted = [recount(r, reversed_=reading.reversed, offset=reading.offset) for r in responses]
        base = BaseProblem.of(recordings_of(counted, orders=(1,)), effects)
        _, problem, best = search_and_refine(base, options)
        _, both = _read_all(problem, best, recordings)
        reading = replace(both[reading.reversed], misfit=best.chi2)
    return reading


def _read_all(
    problem: ExtendedProblem, best: Solution, recordings: Sequence[Recording]
) -> tuple[float, list[_Reading]]:
    """Return the misfit of the angles as told, and the best reading in the sense of rotation and against it."""
    changes = [_changes(problem, best, r, on) for r in recordings if (on := _loaded(r)).any()]
    forward, backward, change = (np.concatenate(parts) for parts in zip(*changes, strict=True))
    readings = [_read(expected, change, against=against) for against, expected in enumerate((forward, backward))]
    return float(np.sum(np.abs(change - forward) ** 2)), readings


def _loaded(recording: Recording) -> NDArray[np.bool_]:
    """Say of every row whether a mass was on, (row,)."""
    on = np.zeros(len(recording.rows), dtype=bool)
    for amounts in recording.trial.values():
        on |= amounts[:-1] != 0
    return on


def _changes(
    problem: ExtendedProblem, best: Solution, recording: Recording, on: NDArray[np.bool_]
) -> tuple[Complex, Complex, Complex]:
    """Return what masses should change by the model, as told and mirrored, and what changed, (value,) in sigmas."""
    measured, p = recording.measured[1], best.p.copy()
    p[problem.parameters.hums] = 0.0  # every recording has its own
    p[problem.parameters.names.index(KEYPHASOR)] = 0.0  # what the mark is off is in the offset

    def predict(masses: Mapping[str, complex]) -> Complex:
        alike = recording.with_trial(masses).numbered(problem.recordings[0].number)
        return np.asarray(problem.on([alike]).model.predict(p, orders=(1,))[0][1], complex)

    without = predict({})
    H = {plane: (predict({plane: UNIT}) - without) / UNIT for plane in recording.trial}
    told, mirrored = (
        sum((H[plane] * u[:, None] for plane, u in masses.items()), np.zeros_like(without))
        for masses in (recording.trial, {plane: u.conj() for plane, u in recording.trial.items()})
    )
    kept = measured.usable & np.append(on, False)[:, None]
    sigma = measured.sigma[kept]
    forward, backward, change = (part[kept] / sigma for part in (told, mirrored, measured.z - without))
    return forward, backward, change


def _read(expected: Complex, change: Complex, *, against: int) -> _Reading:
    """Return the offset at which what is expected comes nearest to what changed, both in standard deviations."""
    product = complex(np.vdot(expected, change))
    square = float(np.sum(np.abs(expected) ** 2))
    misfit = square + float(np.sum(np.abs(change) ** 2)) - 2 * abs(product)
    sigma = 1 / math.sqrt(max(abs(product), 1e-300))
    return _Reading(reversed=bool(against), offset=math.atan2(product.imag, product.real), sigma=sigma, misfit=misfit)


def recount(response: OrderTrackedResponse, *, reversed_: bool, offset: float) -> OrderTrackedResponse:
    """Return a response whose trial masses have their angles from the mark in the sense of rotation."""
    turn = complex(np.exp(1j * offset))

    def counted(u: complex) -> complex:
        return turn * (u.conjugate() if reversed_ else u)

    runs = tuple(
        replace(run, trial_unbalance={plane: counted(complex(u)) for plane, u in run.trial_unbalance.items()})
        for run in response.runs
    )
    return replace(response, runs=runs)
