"""`balance`: which mass to put where, how well that is known, and what it will do."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from rotorrig.balancing.combination import combine, disagreement
from rotorrig.balancing.conditions import Conditions, gather_conditions, vectors_at
from rotorrig.balancing.correction import Correction, least_squares_correction
from rotorrig.balancing.determinacy import ILL_CONDITIONED, Determinacy, judge_determinacy, leave_out
from rotorrig.balancing.discrete import Holes, Placing, place_masses
from rotorrig.balancing.fitted_model import influence_of_fit
from rotorrig.balancing.grade import Grade, grade_of, rotor_mass
from rotorrig.balancing.influence import Influence, estimate_influence
from rotorrig.balancing.min_max import min_max_correction
from rotorrig.balancing.prediction import Comparison, Prediction, compare, predict_vibration
from rotorrig.identify import Identification
from rotorrig.processing import OrderTrackedResponse, require_phases
from rotorrig.rig import DataError, Provenance, code_version

Complex = NDArray[np.complex128]


@dataclass(frozen=True, slots=True, kw_only=True)
class Task:
    """What is wanted of a balance."""

    planes: tuple[str, ...] = ()  # to correct; empty: those with a trial mass, or of the fit
    bands: tuple[tuple[float, float], ...] = ()  # rad/s, of the speeds that count; empty: all
    holes: Mapping[str, Holes] | None = None  # per plane; None: masses of any amount at any angle
    radii: Mapping[str, float] = field(default_factory=dict)  # m, of masses on a plane, where it is known
    min_max: bool = False  # the largest amplitude least, instead of the sum of squares


@dataclass(frozen=True, slots=True, kw_only=True)
class Balance:
    """A correction, by each method and as it was chosen, and the vibration predicted with it."""

    planes: tuple[str, ...]
    radii: Mapping[str, float]  # m, of masses on a plane, where it is known
    conditions: tuple[str, ...]  # names of the runs that the influence coefficients are of
    dof: float  # of their scatter; infinite: it was not measured
    compensated: bool  # a slow-roll vector was subtracted
    corrections: tuple[Correction, ...]  # of the influence coefficients, of the fitted model, of both: those there are
    disagreement: float  # of the two, over its 95 % limit; NaN: there is one only
    chosen: Correction  # by least squares, without an ill-determined combination that is not needed
    determinacy: Determinacy
    left_out: bool  # such a combination was left out
    min_max: Complex | None  # (plane,) kg m
    placing: Placing | None
    mounted: Complex  # (plane,) kg m, what the prediction is of
    by: str  # of the prediction
    prediction: Prediction
    grade: Grade
    comparison: Comparison | None
    source: Provenance


def balance(
    responses: Sequence[OrderTrackedResponse],
    task: Task,
    *,
    identification: Identification | None = None,
    after: OrderTrackedResponse | None = None,
) -> Balance:
    """Balance a rotor from runs with trial masses, from a fit, or from both.

    `after` is a run with the correction on: where it says which masses it had, the prediction is of these. Raises
    DataError where there is neither a trial mass nor a fit, or the trial masses do not tell the planes apart.
    """
    require_phases([*responses, after] if after else responses, "balancing")
    rig = responses[0].rig
    conditions = gather_conditions(responses, bands=task.bands)
    planes = task.planes or conditions.planes or (rig.identify.unbalance if identification and rig.identify else ())
    if not planes:
        raise DataError("no run has a trial mass and there is no fit, want one of them to balance by")
    influences = _influences(responses, conditions, planes, identification, task)
    corrections, apart = _correct(influences)
    chosen = corrections[-1] if apart <= 1 else corrections[0]
    determinacy = judge_determinacy(influences[0], chosen)
    left_out = determinacy.alike and not determinacy.needed
    if left_out:
        chosen = leave_out(chosen, determinacy.worst)
    least_max = min_max_correction(influences[0].z, influences[0].H, chosen.W) if task.min_max else None
    placing = _place(influences[0], chosen, determinacy, task, left_out=left_out) if task.holes else None
    mounted = placing.W if placing else least_max if least_max is not None else chosen.W
    mounted = _read_masses(after, planes, mounted)
    prediction = predict_vibration(influences[0], mounted)
    residual = np.abs(mounted - chosen.W) + chosen.reach
    return Balance(
        planes=planes,
        radii={plane: task.radii[plane] for plane in planes if plane in task.radii},
        conditions=conditions.names if influences[0].conditions else (),
        dof=influences[0].dof,
        compensated=conditions.compensated,
        corrections=corrections,
        disagreement=apart,
        chosen=chosen,
        determinacy=determinacy,
        left_out=left_out,
        min_max=least_max,
        placing=placing,
        mounted=mounted,
        by=influences[0].by,
        prediction=prediction,
        grade=grade_of(residual, mass=rotor_mass(rig), top_speed=float(influences[0].omega.max())),
        comparison=_compare(prediction, after) if after else None,
        source=replace(responses[0].source, code_version=code_version()),
    )


def _influences(
    responses: Sequence[OrderTrackedResponse],
    conditions: Conditions,
    planes: tuple[str, ...],
    identification: Identification | None,
    task: Task,
) -> list[Influence]:
    """Return the influence coefficients, where the trial masses give them, and the model's, where there is a fit."""
    influences = []
    try:
        influences.append(estimate_influence(conditions, planes=planes, prior=responses[0].rig.prior))
    except DataError:
        if identification is None:
            raise
    if identification is not None:
        model = influence_of_fit(identification, responses, planes=planes)
        influences.append(_within(model, task.bands))
    return influences


def _correct(influences: Sequence[Influence]) -> tuple[tuple[Correction, ...], float]:
    """Return the correction of each, last that of both where they agree, and how far two are apart (above 1: not)."""
    corrections = tuple(least_squares_correction(influence) for influence in influences)
    if len(corrections) < 2:
        return corrections, float("nan")
    apart = disagreement(*corrections)
    return (*corrections, combine(*corrections)) if apart <= 1 else corrections, apart


def _within(influence: Influence, bands: Sequence[tuple[float, float]]) -> Influence:
    """Return the entries within bands of speed. Raises DataError if there are none."""
    if not bands:
        return influence
    omega = influence.omega
    kept = np.any([(omega >= low) & (omega <= high) for low, high in bands], axis=0)
    if not kept.any():
        raise DataError("the fit's response has no row within the speeds asked for, want other speeds")
    names = "probe omega direction z H z_columns H_columns measured measured_columns next_run own measured_own"
    return replace(influence, **{name: getattr(influence, name)[kept] for name in names.split()})


def _place(
    influence: Influence, chosen: Correction, determinacy: Determinacy, task: Task, *, left_out: bool
) -> Placing:
    """Return the masses in the holes; a combination that was left out costs there as one that is just determined."""
    assert task.holes is not None
    H = influence.H
    if left_out:
        row = determinacy.best.effect / ILL_CONDITIONED * determinacy.worst.weights.conj()
        H = np.concatenate([H, row[None]])
    z = np.concatenate([influence.z, np.zeros(len(H) - len(influence.z))]) if task.min_max else None
    return place_masses(chosen.W, H, [task.holes[plane] for plane in influence.planes], z=z)


def _read_masses(after: OrderTrackedResponse | None, planes: tuple[str, ...], mounted: Complex) -> Complex:
    """Return the masses that a run after balancing says it had; `mounted` if it says nothing.

    Raises DataError if it had one on another plane.
    """
    said = next((run.trial_unbalance for run in after.runs if any(run.trial_unbalance.values())), {}) if after else {}
    other = [plane for plane, u in said.items() if u and plane not in planes]
    if other:
        raise DataError(f"the run after balancing had a mass on '{other[0]}', want masses on {list(planes)} alone")
    return np.array([said.get(plane, 0) for plane in planes], complex) if said else mounted


def _compare(prediction: Prediction, after: OrderTrackedResponse) -> Comparison:
    if after.probes != prediction.probes:
        raise DataError(f"the run after has the probes {list(after.probes)}, want {list(prediction.probes)}")
    measured = vectors_at(after, prediction.omega, prediction.direction, prediction.probe)
    if not np.isfinite(measured).any():
        raise DataError("the run after balancing has no speed in common with the runs before, want the same sweep")
    return compare(prediction, measured)
