"""The verdict in one or two sentences."""

from collections.abc import Sequence

import numpy as np

from rotorrig.identify.adequacy import Adequacy
from rotorrig.identify.identification import NameplateFinding
from rotorrig.identify.verdict.cause import Cause
from rotorrig.identify.verdict.gain import Predictions
from rotorrig.identify.verdict.verdict import Verdict
from rotorrig.rig.config import micrometres

NOT_YET_ALL = "That is not yet all"  # of a verdict whose causes leave a misfit
_LEAST_P, _MOST_P = 1e-6, 0.99  # that are told


def sentence(
    verdict: Verdict,
    before: Adequacy,
    after: Adequacy,
    causes: Sequence[Cause],
    tied: Sequence[Sequence[str]],
    predictions: Predictions,
    otherwise: Sequence[str] = (),
) -> str:
    """Say what was concluded, from the tests before and after the model was extended.

    `otherwise` is what would have to be wrong of the config without the causes.
    """
    if verdict is Verdict.ADEQUATE:
        return f"The model is adequate: {_figures(before)}."
    if verdict is Verdict.CANNOT_TELL:
        return (
            f"This data cannot tell: the model fits ({_figures(before)}), but fewer than half of the known causes "
            "would show in it if they were there."
        )
    if verdict is Verdict.DESCRIBED:
        return f"The model is NOT adequate: {_figures(before)}. {_worst(before)} No cause that is known explains it."
    if verdict is Verdict.UNEXPLAINED:
        return (
            f"The model is NOT adequate: {_figures(before)}. {_worst(before)} {_attempt(after, causes, predictions)}."
        )
    words = "; ".join(cause.words for cause in causes if cause.chosen)
    bought = _say_gain(predictions) if predictions.better or not otherwise else _say_otherwise(otherwise, predictions)
    if not after.adequate:
        bought += f" {NOT_YET_ALL}: {_figures(after)}."
    if verdict is Verdict.TIED:
        others = " or ".join(", ".join(group[1:]) for group in tied)
        return f"The model is wrong here: {words} - or as likely, for all this data can tell: {others}. {bought}"
    return f"The model is wrong here: {words}. {bought}"


def _say_gain(predictions: Predictions) -> str:
    return (
        f"With that the error on data no fit saw ({predictions.on}) goes from {micrometres(predictions.before.error)} "
        f"to {micrometres(predictions.after.error)} um 0-peak, "
        f"{predictions.after.over_floor:.1f} times the noise floor."
    )


def _say_otherwise(misstated: Sequence[str], predictions: Predictions) -> str:
    """Say what speaks for causes without which unseen data are predicted as well."""
    before, after = (micrometres(each.error) for each in (predictions.before, predictions.after))
    return (
        f"Without that the error on data no fit saw ({predictions.on}) is {before} um 0-peak, "
        f"with it {after} um 0-peak; but then the config would have to be wrong: {'; '.join(misstated)}."
    )


def with_missing(concluded: str, missing: str, shortfall: str, predictions: Predictions) -> str:
    """Say what a model lacks that no known cause is: found, or what comes nearest and why that is no finding."""
    if not shortfall:
        return f"{concluded} What is missing: {missing}. {_say_gain(predictions)}"
    return f"{concluded} Of single forces and readings this comes nearest, no finding, for {shortfall}: {missing}."


def cut_short(before: Adequacy, after: Adequacy, causes: Sequence[Cause]) -> str:
    """Say what is known of a diagnosis that was ended before every cause was tried."""
    fits = "is adequate" if before.adequate else "is NOT adequate"
    labels = " and ".join(cause.label for cause in causes if cause.chosen)
    best = f"Best so far is {labels}, with which {_figures(after)}" if labels else "No cause was found so far"
    return (
        f"Cut short before every cause was tried, and without a test on data no fit saw: the model {fits}: "
        f"{_figures(before)}. {best}."
    )


def _attempt(after: Adequacy, causes: Sequence[Cause], predictions: Predictions) -> str:
    """Say what was tried in vain."""
    labels = " and ".join(cause.label for cause in causes if cause.chosen)
    if not labels:
        return f"None of the known causes explains it: {_figures(after)}"
    if not predictions.better:
        after_it, before_it = (micrometres(each.error) for each in (predictions.after, predictions.before))
        without = "as without" if after_it == before_it else f"{before_it} um 0-peak without"
        better = (
            f"does not clearly predict data no fit saw ({predictions.on}) any better: "
            f"off by {after_it} um 0-peak, {without}"
        )
        return f"With {labels} it fits better, but {better}"
    if predictions.agreement and not predictions.agreed:
        parts = f"{predictions.agreement.between}, p = {predictions.agreement.p:.2g}"
        return f"With {labels} it fits better, but finds another rotor in each part of the data ({parts})"
    return f"Not even with {labels} is it adequate: {_figures(after)}"


def with_nameplate(
    concluded: str,
    verdict: Verdict,
    after: Adequacy,
    pulled: Sequence[NameplateFinding],
    tied: Sequence[Sequence[str]],
) -> str:
    """Say what of the config is wrong, with the conclusion on effects; `tied` are the sets of `nameplate_ties`."""
    if not pulled:
        return concluded
    if verdict is Verdict.UNEXPLAINED:
        titles = ", ".join(finding.deviation.title for finding in pulled)  # sizes would be of a model that is wrong
        return f"{concluded} The fit pulls at the config as well, perhaps for that same unknown reason: {titles}."
    if not after.adequate:
        told = "; ".join(finding.deviation.words for finding in pulled)
        return f"{concluded} The fit pulls at the config as well, perhaps for what is left unexplained: {told}."
    told = "; ".join(_with_rivals(finding, tied) for finding in pulled)
    if verdict in (Verdict.ADEQUATE, Verdict.CANNOT_TELL):
        return f"The config is wrong here: {told}. With that the model is adequate: {_figures(after)}."
    return f"{concluded} The config is wrong as well: {told}."


def _with_rivals(finding: NameplateFinding, tied: Sequence[Sequence[str]]) -> str:
    """Return a finding with the effects that explain nearly as much."""
    own = {finding.deviation.label, *(other.label for other in finding.alternatives)}
    group = next((group for group in tied if group[0] == finding.deviation.label), ())
    return "; or ".join([finding.words, *(label for label in group if label not in own)])


def moving(cause: Cause, rest: str) -> str:
    """Say what a quasi-static base gets wrong, then what the swept one is told."""
    return (
        f"The quasi-static model is wrong here: {cause.words}. With that the error on data no fit saw (blocks of "
        f"speeds in turn) goes from {micrometres(cause.heldout_before)} to {micrometres(cause.heldout_after)} um "
        f"0-peak. With the moving speed in it {rest[:1].lower()}{rest[1:]}"
    )


def character(adequacy: Adequacy) -> str:
    """Describe a residual that no known cause explains: orders, speeds, directions and probes it is loud at."""
    loud = [m for m in adequacy.misfits if m.sigma > adequacy.limit] or list(adequacy.misfits[:1])
    orders = sorted({m.order for m in loud})
    probes = sorted({m.probe for m in loud})
    runs = sorted({m.run for m in loud})
    rpm = 30 / np.pi
    low, high = min(m.speed_from for m in loud) * rpm, max(m.speed_to for m in loud) * rpm
    return (
        f"What is left is at {' and '.join(f'{o:g}X' for o in orders)}, from {low:.0f} to {high:.0f} rpm, in the "
        f"{' and '.join(runs)} run{'s' if len(runs) > 1 else ''}, at {', '.join(probes)}; at its loudest: "
        f"{loud[0].sentence}"
    )


def centreline(adequacy: Adequacy) -> str:
    """Say where the mean position moves most, "" if nowhere; no effect predicts that, so it decides no verdict."""
    return f"The mean position is not steady: {adequacy.centreline[0].sentence}" if adequacy.centreline else ""


def _figures(adequacy: Adequacy) -> str:
    p = f"p = {adequacy.p:.2g}" if adequacy.p >= _LEAST_P else f"p < {_LEAST_P:g}"
    p = f"p > {_MOST_P:g}" if adequacy.p > _MOST_P else p
    return (
        f"1X residuals at {adequacy.scatter_ratio:.3g} times their scatter from row to row, the worst stretch of "
        f"speeds at {adequacy.worst_sigma:.1f} sigma (limit {adequacy.limit:.1f}), {p}"
    )


def _worst(adequacy: Adequacy) -> str:
    """Return the loudest stretch of each order."""
    return " ".join({m.order: m.sentence for m in reversed(adequacy.misfits)}.values())
