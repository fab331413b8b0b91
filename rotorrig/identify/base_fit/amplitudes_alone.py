"""Identification from amplitudes alone: what it can be asked for, which rows it takes, and how its fit is tested."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from rotorrig.identify.adequacy import ADEQUACY, scatter_test
from rotorrig.identify.base_fit.base_fit import count_values_followed
from rotorrig.identify.base_model import ObjectiveName
from rotorrig.identify.extended_model import ExtendedProblem
from rotorrig.identify.least_squares import Solution
from rotorrig.processing import OrderTrackedResponse
from rotorrig.rig import ConfigError, DataError

NOT_TOLD = (
    "Amplitudes alone were fitted, as the response has no phases. They do not tell the phase of the unbalance, where "
    "the keyphasor mark is, and whether the rotor whirls forward or backward; what runout adds to them hardly shows."
)
TRIALS_LEFT_OUT = "Runs with a trial mass were left out: what one changes is told by phases."


def take_amplitudes(
    responses: Sequence[OrderTrackedResponse], *, objective: ObjectiveName, bootstrap: bool
) -> tuple[list[OrderTrackedResponse], tuple[str, ...]]:
    """Return the responses as they are fitted, without trial runs, and what is to be said of it.

    Nothing is changed or said where phases are known. Raises DataError where only some of them have phases, where every
    run has a trial mass, or for what wants phases: the objective "residual" and a bootstrap. Raises ConfigError if the
    config has effects.
    """
    alone = [response.amplitudes_alone for response in responses]
    if not any(alone):
        return list(responses), ()
    name = responses[alone.index(True)].source.source or "response"
    if not all(alone):
        raise DataError(f"{name}: holds amplitudes without phases and another response has phases, want all of a kind")
    if objective == "residual":
        raise DataError(
            f"{name}: holds amplitudes without phases, want an objective on amplitudes: rotor identify --objective f1"
        )
    if bootstrap:
        raise DataError(f"{name}: holds amplitudes without phases, and a bootstrap draws vectors; want it left out")
    if responses[0].rig.effects:
        raise ConfigError(f"{name}: holds amplitudes without phases, want a config without effects to fit them by")
    bare = [_without_trials(response) for response in responses]
    left_out = any(after is not before for after, before in zip(bare, responses, strict=True))
    return bare, (NOT_TOLD, TRIALS_LEFT_OUT) if left_out else (NOT_TOLD,)


def _without_trials(response: OrderTrackedResponse) -> OrderTrackedResponse:
    """Return the response with nothing usable in runs with a trial mass; itself if there is none. Raises DataError."""
    bare = np.array([not run.trial_unbalance for run in response.runs])[response.run]
    if bare.all():
        return response
    if not bare.any():
        raise DataError(f"{response.source.source}: every run carries a trial mass, want one without")
    return replace(response, usable=response.usable & bare[:, None])


def judge_amplitudes(problem: ExtendedProblem, best: Solution) -> tuple[float, float, bool]:
    """Return the ratio of the residuals to their scatter from row to row, its probability, and whether it is adequate.

    The global test of `adequacy` on the one real value that an amplitude is; stretches of speed are not looked at.
    """
    used = count_values_followed(problem, best)
    ratios, probabilities = [], []
    for recording, predicted in zip(problem.recordings, problem.model.predict(best.p), strict=True):
        measured = recording.measured[1]
        white = measured.sigmas(measured.off(predicted[1]))[:-1, 0::2]
        white = np.where(measured.usable[:-1], white, np.nan)
        ratio, p = scatter_test(white, recording.response.run[recording.rows], used=used[recording.number])
        ratios.append(ratio)
        probabilities.append(p)
    p = 1 - (1 - min(probabilities)) ** len(probabilities)
    return max(ratios), p, p >= ADEQUACY.false_alarm_rate
