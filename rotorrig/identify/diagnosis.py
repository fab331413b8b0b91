"""Diagnosis of a rig from its responses: adequacy of the base model, where it parts from the measurement, and why.

The base model is fitted to all recordings together; what its residual calls for is looked for among the effects of
sims/effects (stepwise_selection.py), named or not (verdict.py), and what the extended model buys is measured on data
that no fit saw (cross_validation.py). Where none of them explains it, the force that would is looked for (discovery).
"""

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from rotorrig.identify import base_fit
from rotorrig.identify.adequacy import ADEQUACY, Adequacy, Misfit
from rotorrig.identify.base_fit import AssessedFit, config_effects
from rotorrig.identify.causes import Selection, candidates
from rotorrig.identify.discovery import Discovery, MissingForce, discover
from rotorrig.identify.extended_model import recordings_of
from rotorrig.identify.identification import NO_CHECK, ModelResonance, NameplateCheck
from rotorrig.identify.uncertainty import check_nameplate, model_resonances
from rotorrig.identify.verdict import (
    Cause,
    Gain,
    HiddenEffect,
    NameplateSelection,
    NextRun,
    Unseen,
    Verdict,
    conclude,
    conclude_with_nameplate,
    effect_ties,
    gain,
    hidden_effects,
    is_supported,
    leave_out_excess,
    leave_out_idle,
    moving_speed,
    nameplate_ties,
    next_run,
    rank_causes,
    rank_with_nameplate,
    select_beside_nameplate,
    sentences,
    visible_share,
)
from rotorrig.processing import OrderTrackedResponse, require_phases
from rotorrig.rig import DataError, Provenance, code_version

Progress = Callable[[str, float], None]

_SHOWN = 12  # stretches listed, worst first


@dataclass(frozen=True, slots=True, kw_only=True)
class Diagnosis:
    """The verdict on the base model, with its evidence."""

    verdict: Verdict
    sentence: str  # the verdict for a person, in one or two sentences
    false_alarm_rate: float  # of the adequacy test, as stated
    noise_floor: float  # m, median 1-sigma of a 1X component
    chi2: float
    dof: int
    p: float  # of the adequacy test: that a right model has residuals as large
    worst: tuple[Misfit, ...]  # most serious first; those of the mean position (order 0) last
    residual: NDArray[np.complex128]  # (speed, probe, order) m, measured less model, orders as in the response
    sigmas: NDArray[np.float64]  # (speed, probe, order) the same in standard deviations
    model: str = "swept"  # or "quasi-static": the base took every row for steady motion
    causes: tuple[Cause, ...] = ()  # best first, the chosen ones before all others
    tied: tuple[tuple[str, ...], ...] = ()  # sets of labels the data cannot separate
    next_run: NextRun | None = None  # the cheapest that tells more, or why there is none; None: nothing is open
    gain: Gain | None = None  # what the extended model bought on data no fit saw; None: it was not extended
    nameplate: NameplateCheck = NO_CHECK  # pulls of the final model, and what of the config they contradict
    hidden: tuple[HiddenEffect, ...] = ()  # effects this data would not show, with the size that would
    cut_short: bool = False  # before every cause was tried: `causes` are the best so far
    missing: MissingForce | None = None  # where no known cause explains it: the force or reading that would
    character: str = ""  # of the residual, where no known cause explains it
    extended_residual: NDArray[np.complex128] | None = None  # as `residual`, of the extended model; None: there is none
    extended_sigmas: NDArray[np.float64] | None = None  # as `sigmas`, likewise; None of an older file too
    resonances: tuple[ModelResonance, ...] = ()  # of the extended model, or of the base where there is none
    responses: tuple[tuple[str, int], ...] = ()  # source hash and rows of each response, in the order of the rows
    source: Provenance


def diagnose(
    responses: Sequence[OrderTrackedResponse],
    *,
    holdout: OrderTrackedResponse | None = None,
    model: Literal["swept", "quasi-static"] = "swept",
    without: Collection[str] = (),
    not_possible: Collection[str] = (),
    seed: int = 0,
    progress: Progress = lambda stage, share: None,
    go_on: Callable[[], bool] = lambda: True,
) -> Diagnosis:
    """Judge the base model by recordings of one rig, with and without trial masses, and name what it lacks.

    A "quasi-static" base takes the speed of every row as steady; if that is what is wrong with it, it is the first
    cause, and the others are looked for beside it.

    Runs of a rotor turning the other way are recordings whose rig has the other sense of rotation than the first's;
    force laws are then not among the causes. Effects in the rig's config are part of the base. `holdout` is a recording
    no fit may see; without one the gain is measured across blocks of speeds. Names in `without` are not tried. Kinds
    of runs in `not_possible` ("trial mass", "ramp rate") are not proposed for the next.

    `go_on` is asked between steps of the search for causes. Once it says no, the diagnosis ends with the best so far,
    marked as cut short, which names nothing.

    Raises ConfigError if the rig has no [identify] table or an unknown effect, DataError if a recording holds too few
    rows or other probes or orders than the first.
    """
    if not responses:
        raise DataError("no response was given, want at least one to diagnose")
    require_phases([*responses, holdout] if holdout else responses, "a diagnosis")
    if model == "quasi-static" and (steady := _quasi_static_base(responses, seed=seed, progress=progress)):
        judge = partial(diagnose, responses, holdout=holdout, without=without, not_possible=not_possible, seed=seed)
        return _add_moving_speed(judge(progress=progress, go_on=go_on), *steady)
    with threadpool_limits(1, user_api="blas"):
        progress("base model", 0.0)
        recordings = recordings_of(responses, swept=model == "swept")
        known = candidates(recordings, without=without)
        base = base_fit.fit_base(recordings, config_effects(responses[0].rig), seed=seed)
        progress("causes", 0.1)
        found = select_beside_nameplate(base, known, lambda stage, share: progress(stage, 0.1 + 0.6 * share), go_on)
        if not go_on():
            return replace(_cut_short(responses, found), model=model)
        progress("unseen data", 0.7)
        hidden = recordings_of([holdout], swept=model == "swept", like=responses[0])[0] if holdout else None
        unseen = Unseen(found.start.problem, found.start.polished.p, holdout=hidden)
        verdict, selection, extended, predictions = _judge(found, unseen)
        progress("next run", 0.8)
        further = _find_next_run(verdict, selection, not_possible)
        missing = None
        if verdict is Verdict.UNEXPLAINED:
            progress("missing force", 0.85)
            missing = discover(found.start, selection, unseen, go_on)
            if missing and missing.missing.is_described:
                verdict, selection = Verdict.DESCRIBED, missing.selection
                extended, predictions = missing.extended, missing.predictions
        found = replace(found, selection=selection)
        diagnosis = _assemble(responses, found, extended, verdict, predictions, missing)
        diagnosis = replace(diagnosis, model=model, next_run=further)
    progress("done", 1.0)
    return diagnosis


def _judge(found: NameplateSelection, unseen: Unseen) -> tuple[Verdict, Selection, AssessedFit, gain.Predictions]:
    """Return the verdict on what was selected, what of it is kept, the model with that, and what is predicted by it."""
    start, selection = found.start, leave_out_idle(found.selection, unseen).with_law_error()
    misstated = partial(_count_misstated, found)
    if start.adequacy.adequate:
        selection = leave_out_excess(selection, misstated)
    extended = start
    if selection.problem is not start.problem:
        extended = base_fit.assess_fit(selection.problem, selection.polished)
    wrong = misstated(selection)
    predictions = gain.predict_unseen(selection, unseen, adequate=extended.adequacy.adequate, misstated=wrong)
    eases = found.is_eased_by(extended)
    supported = is_supported(selection, predictions, eases_priors=eases)
    if start.adequacy.adequate and not supported:
        selection, extended = selection.without_causes(), start
        wrong = misstated(selection)
    verdict = conclude(
        selection,
        adequate_before=start.adequacy.adequate,
        adequate_after=extended.adequacy.adequate,
        visible=visible_share(selection),
        predictions=predictions,
        misstated=wrong,
        eases_priors=eases,
    )
    return verdict, selection, extended, predictions


def _count_misstated(found: NameplateSelection, selection: Selection) -> int:
    """Return how many statements of the nameplate a selection contradicts."""
    return len(found.pulled_far(check_nameplate(selection.polished, selection.problem)))


def _find_next_run(verdict: Verdict, selection: Selection, not_possible: Collection[str]) -> NextRun | None:
    """Return the run to make next; None where there is nothing left to find out."""
    if verdict is Verdict.TIED:
        return next_run.find_next_run(selection, not_possible=not_possible)
    if verdict in (Verdict.UNEXPLAINED, Verdict.CANNOT_TELL):
        return next_run.find_other_run(selection, not_possible=not_possible)
    return None


def _quasi_static_base(
    responses: Sequence[OrderTrackedResponse], *, seed: int, progress: Progress
) -> tuple[AssessedFit, Cause] | None:
    """Return the quasi-static base and what is wrong with it; None if it is not that the speed was moving."""
    progress("steady and moving speed", 0.0)
    with threadpool_limits(1, user_api="blas"):
        still, moving = (
            base_fit.fit_base(
                recordings_of(responses, swept=swept),
                config_effects(responses[0].rig),
                seed=seed,
            )
            for swept in (False, True)
        )
        cause = moving_speed(still, moving, responses)
    return (still, cause) if cause else None


def _add_moving_speed(diagnosis: Diagnosis, still: AssessedFit, cause: Cause) -> Diagnosis:
    """Return the diagnosis by the swept model as one of the quasi-static base."""
    adequacy = still.adequacy
    return replace(
        diagnosis,
        model="quasi-static",
        verdict=Verdict.NAMED if diagnosis.verdict is Verdict.ADEQUATE else diagnosis.verdict,
        sentence=sentences.moving(cause, diagnosis.sentence),
        chi2=still.polished.chi2,
        dof=still.polished.dof,
        p=adequacy.p,
        worst=_worst(adequacy),
        residual=adequacy.residual,
        sigmas=adequacy.sigmas,
        causes=(cause, *diagnosis.causes),
    )


def _cut_short(responses: Sequence[OrderTrackedResponse], found: NameplateSelection) -> Diagnosis:
    """Return what is known when not every cause was tried, nor any model on unseen data: no cause is named."""
    extended, selection = found.base, found.selection
    if selection.problem is not extended.problem:
        extended = base_fit.assess_fit(selection.problem, selection.polished)
    verdict = Verdict.CANNOT_TELL if found.start.adequacy.adequate else Verdict.UNEXPLAINED
    return replace(_assemble(responses, found, extended, verdict, None), cut_short=True)


def _assemble(
    responses: Sequence[OrderTrackedResponse],
    found: NameplateSelection,
    extended: AssessedFit,
    verdict: Verdict,
    predictions: gain.Predictions | None,
    discovery: Discovery | None = None,
) -> Diagnosis:
    """Return the diagnosis; without `predictions` of unseen data it was cut short."""
    base, selection = found.base, found.selection
    adequacy = base.adequacy
    check = check_nameplate(extended.polished, extended.problem)
    pulled = found.pulled_far(check)
    whole = verdict is not Verdict.UNEXPLAINED and extended.adequacy.adequate
    named = pulled if whole else ()  # what is not explained, by a law that explains nearly all too, may pull at it
    ties, of_nameplate = effect_ties(found), nameplate_ties(found, named)
    causes = rank_causes(selection, predictions.by_label if predictions else {})
    source = responses[0].source
    was_extended = selection.problem.effects != base.problem.effects
    verdict = conclude_with_nameplate(verdict, (), ties)
    if predictions is None:
        concluded = sentences.cut_short(found.start.adequacy, extended.adequacy, causes)
    else:
        before, otherwise = found.start.adequacy, found.describe_misstated()
        concluded = sentences.sentence(verdict, before, extended.adequacy, causes, ties, predictions, otherwise)
        if discovery:
            missing = discovery.missing
            concluded = sentences.with_missing(concluded, missing.words, missing.shortfall, discovery.predictions)
    concluded = sentences.with_nameplate(concluded, verdict, extended.adequacy, pulled, of_nameplate)
    return Diagnosis(
        verdict=conclude_with_nameplate(verdict, named, of_nameplate),
        sentence=f"{concluded} {sentences.centreline(adequacy)}".rstrip(),
        false_alarm_rate=ADEQUACY.false_alarm_rate,
        noise_floor=adequacy.noise_floor,
        chi2=base.polished.chi2,
        dof=base.polished.dof,
        p=adequacy.p,
        worst=_worst(adequacy),
        residual=adequacy.residual,
        sigmas=adequacy.sigmas,
        causes=rank_with_nameplate(causes, found, check, named),
        tied=(*ties, *of_nameplate),
        nameplate=check,
        gain=gain.measure_gain(base, selection, predictions) if predictions and was_extended else None,
        hidden=hidden_effects(selection),
        missing=discovery.missing if discovery else None,
        character=sentences.character(extended.adequacy) if verdict is Verdict.UNEXPLAINED else "",
        extended_residual=extended.adequacy.residual if extended is not base else None,
        extended_sigmas=extended.adequacy.sigmas if extended is not base else None,
        resonances=model_resonances(extended.polished, extended.problem),
        responses=tuple((r.source.source_hash, len(r.omega)) for r in responses),
        source=replace(source, code_version=code_version()),
    )


def _worst(adequacy: Adequacy) -> tuple[Misfit, ...]:
    return (*adequacy.misfits[:_SHOWN], *adequacy.centreline)
