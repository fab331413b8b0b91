"""Speeds at which two models part: where their predictions do, apart from each other and outside critical bands."""

import itertools
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.extended_model.model import ExtendedModel
from rotorrig.identify.extended_model.problem import ExtendedProblem
from rotorrig.identify.extended_model.tracked_recording import Recording
from rotorrig.identify.least_squares import Solution
from rotorrig.identify.verdict.next_run.dwells import parting_speeds
from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.config.devices import CriticalBand
from rotorrig.rig.config.units import RPM
from tests.identify.swept import swept_response


def fits_of(rig: RigConfig, hidden: NDArray[np.float64]) -> tuple[tuple[ExtendedProblem, Solution], ...]:
    """Return a problem with three fits of it: as it is, and of an unbalance that is larger by a little and by more."""
    response = swept_response(rig, speeds=(480, 3600))
    problem = ExtendedProblem(ExtendedModel([Recording(response)], ()))
    p = problem.parameters.start(np.zeros(0))
    p[problem.parameters.base.sought] = hidden[problem.parameters.base.sought]
    fit = problem.solve(problem.solve_linear(p, np.arange(len(p))))
    larger = np.ones((2, len(p)))
    larger[:, problem.parameters.base.unbalance] = np.array([[1.01], [1.1]])
    return ((problem, fit), *((problem, replace(fit, p=fit.p * factor)) for factor in larger))


def test_models_part_most_at_the_resonance_where_they_differ_by_a_share(
    one_plane: RigConfig, hidden: NDArray[np.float64]
) -> None:
    fit, close, far = fits_of(one_plane, hidden)
    problem, solution = fit
    (predicted,) = problem.model.predict(solution.p)
    recording = problem.recordings[0]
    omega = recording.response.omega[recording.rows]
    peak = omega[np.sum(np.abs(predicted[1][: len(omega)]) ** 2, axis=1).argmax()]
    speeds = parting_speeds(fit, [close])
    assert len(speeds) == 4
    assert min(abs(speed / peak - 1) for speed in speeds) < 0.01
    assert min(b / a for a, b in itertools.pairwise(speeds)) >= 1.03
    assert speeds == parting_speeds(fit, [far, close]), "the nearest of them counts"
    assert parting_speeds(fit, [fit]) == (), "of models that say the same nothing is worth holding"


def test_nothing_is_held_in_a_critical_band(one_plane: RigConfig, hidden: NDArray[np.float64]) -> None:
    low, high = 2000 / RPM, 2500 / RPM
    assert one_plane.limits is not None
    band = CriticalBand(low=f"{low * RPM} rpm", high=f"{high * RPM} rpm", vibration="900 um")
    limits = one_plane.limits.model_copy(update={"critical_bands": (band,)})
    fit, close, _ = fits_of(one_plane.model_copy(update={"limits": limits}), hidden)
    speeds = np.array(parting_speeds(fit, [close]))
    assert len(speeds)
    assert not ((speeds >= low) & (speeds <= high)).any()
    without, near, _ = fits_of(one_plane, hidden)
    assert any(low <= speed <= high for speed in parting_speeds(without, [near])), "where they part"
