"""Prediction of what a fit never saw."""

from dataclasses import replace

import numpy as np
import pytest

from rotorrig.identify.extended_model.model import ExtendedModel
from rotorrig.identify.extended_model.problem import ExtendedProblem
from rotorrig.identify.extended_model.tracked_recording import Recording
from rotorrig.identify.verdict.cross_validation import cross_validate, divide, folds_of, measure_prediction
from rotorrig.identify.verdict.part_fits import PartFits
from rotorrig.identify.verdict.settings import VERDICT
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.errors import DataError
from rotorrig.sims.effects.base import find
from tests.identify.swept import DRAWN, SIGMA, U, swept_response


class Watched(ExtendedProblem):
    """Keeps which rows each of the problems made of it may see."""

    shown: list[list[Recording]]

    def on(self, recordings):  # type: ignore[no-untyped-def]
        self.shown.append(list(recordings))
        return super().on(recordings)


def watched(recordings: list[Recording]) -> Watched:
    problem = Watched(ExtendedModel(recordings))
    problem.shown = []
    return problem


def rows(recordings: list[Recording], number: int) -> np.ndarray:
    """Which rows of a recording are among these, (row,)."""
    found = [r.measured[1].usable[:-1].any(axis=1) for r in recordings if r.number == number]
    return np.any(found, axis=0) if found else np.array(False)


@pytest.mark.parametrize("count", [1, 2])
def test_what_is_predicted_was_not_fitted_and_all_is_predicted_once(
    healthy: OrderTrackedResponse, hidden: np.ndarray, count: int
) -> None:
    problem = watched([Recording(healthy, number=i) for i in range(count)])
    cross_validate(problem, problem.parameters.start(hidden))
    fitted, told = problem.shown[::2], problem.shown[1::2]
    assert len(fitted) == len(told) == VERDICT.folds > 1
    for number in range(count):
        for seen, unseen in zip(fitted, told, strict=True):
            assert not (rows(seen, number) & rows(unseen, number)).any()
        np.testing.assert_array_equal(np.sum([rows(part, number) for part in told], axis=0), 1)


def test_neighbours_which_a_fit_could_copy_are_left_out_together(
    healthy: OrderTrackedResponse, hidden: np.ndarray
) -> None:
    problem = watched([Recording(healthy)])
    cross_validate(problem, problem.parameters.start(hidden))
    up = rows(problem.shown[0], 0)[healthy.run == 0]
    changes = np.flatnonzero(np.diff(up.astype(int)))
    assert len(changes)
    assert (np.diff(changes) >= len(up) // VERDICT.blocks).all()


def test_what_is_hidden_in_one_run_is_shown_in_the_next(healthy: OrderTrackedResponse, hidden: np.ndarray) -> None:
    """Else a fit may have seen nothing of a resonance."""
    problem = watched([Recording(healthy)])
    cross_validate(problem, problem.parameters.start(hidden))
    for unseen in problem.shown[1::2]:
        up, down = (rows(unseen, 0)[healthy.run == number] for number in (0, 1))
        speeds = [healthy.omega[healthy.run == number] for number in (0, 1)]
        nearest = np.argmin(np.abs(speeds[0][up][:, None] - speeds[1]), axis=1)
        assert down[nearest].mean() < 0.1


def test_the_right_model_predicts_a_healthy_rig_as_well_as_the_noise_allows(
    healthy: OrderTrackedResponse, hidden: np.ndarray
) -> None:
    problem = ExtendedProblem(ExtendedModel([Recording(healthy)]))
    found = cross_validate(problem, problem.parameters.start(hidden))
    assert 0.9 * DRAWN * SIGMA * np.sqrt(2) < found.error < 1.2 * found.floor


def test_a_step_to_where_the_rotor_has_no_motion_is_not_taken(
    healthy: OrderTrackedResponse, hidden: np.ndarray, monkeypatch: pytest.MonkeyPatch
) -> None:
    problem = ExtendedProblem(ExtendedModel([Recording(healthy)]))
    p = problem.parameters.start(hidden)
    fitted, not_fitted = cross_validate(problem, p).error, measure_prediction(problem, p, problem.recordings).error
    residual = ExtendedProblem.residual

    def at_one_vector_only(self: ExtendedProblem, moved: np.ndarray) -> np.ndarray:
        if not np.array_equal(moved, p):
            raise DataError("law: its force is not found")
        return residual(self, moved)

    monkeypatch.setattr(ExtendedProblem, "residual", at_one_vector_only)
    assert cross_validate(problem, p).error == pytest.approx(not_fitted, rel=1e-9, abs=0)
    assert not_fitted != pytest.approx(fitted, rel=1e-3, abs=0)


def test_the_error_of_a_known_offset_is_that_offset(rig: RigConfig, hidden: np.ndarray) -> None:
    recording = Recording(swept_response(rig))
    problem = ExtendedProblem(ExtendedModel([recording]))
    p = problem.parameters.start(hidden)
    p[problem.parameters.base.unbalance] = U.real, U.imag
    (exact,) = problem.model.predict(p)
    moved = {n: z + 2e-6j for n, z in exact.items()}
    found = measure_prediction(problem, p, [recording.instead(moved)])
    assert found.error == pytest.approx(2e-6)
    assert found.over_floor == pytest.approx(found.error / found.floor)
    assert found.floor >= SIGMA * np.sqrt(2)


@pytest.mark.parametrize("known", [True, False])
def test_the_folds_are_fitted_as_well_as_if_carried_to_the_end(rig: RigConfig, hidden: np.ndarray, known: bool) -> None:
    effect = find(rig, "skew_stiffness")
    theta = {q.name: 0.5 * q.size for q in effect.parameters}
    response = swept_response(rig, rng=np.random.default_rng(21), hidden=[(effect, theta)])
    problem = ExtendedProblem(ExtendedModel([Recording(response)])).extended([effect] if known else [])
    fit = problem.solve(problem.parameters.start(hidden))
    recording = problem.recordings[0]
    fold = divide(recording, VERDICT.folds)
    square = count = 0.0
    for hide in range(VERDICT.folds):
        seen, unseen = problem.on([recording.only(fold != hide)]), recording.only(fold == hide)
        error = measure_prediction(seen, seen.solve(fit.p, tolerance=1e-3).p, [unseen]).error
        rows = np.sum(unseen.measured[1].usable[:-1])
        square, count = square + rows * error**2, count + rows
    assert cross_validate(problem, fit.p).error == pytest.approx(np.sqrt(square / count), rel=0.02)


def test_rows_that_are_not_usable_do_not_count(healthy: OrderTrackedResponse, hidden: np.ndarray) -> None:
    z, usable = healthy.z.copy(), healthy.usable.copy()
    z[10:20, 2] = np.nan
    z[30, 1] = 1e-2
    usable[10:20, 2] = usable[30, 1] = False
    problem = ExtendedProblem(ExtendedModel([Recording(replace(healthy, z=z, usable=usable))]))
    found = cross_validate(problem, problem.parameters.start(hidden))
    assert 0.9 * DRAWN * SIGMA * np.sqrt(2) < found.error < 1.2 * found.floor


def test_the_true_effect_predicts_better_than_none(rig: RigConfig, hidden: np.ndarray) -> None:
    effect = find(rig, "unbalance_plane, at 160 mm")
    response = swept_response(
        rig, rng=np.random.default_rng(9), hidden=[(effect, {"unbalance re": 20e-6, "unbalance im": 0.0})]
    )
    errors = []
    for effects in ([], [effect]):
        problem = ExtendedProblem(ExtendedModel([Recording(response)], effects))
        fit = problem.solve(problem.parameters.start(hidden))
        errors.append(cross_validate(problem, fit.p).error)
    assert errors[1] < 0.7 * errors[0]


def test_folds_and_fits_that_others_have_made_serve_as_well_as_own_ones(
    healthy: OrderTrackedResponse, hidden: np.ndarray
) -> None:
    problem = ExtendedProblem(ExtendedModel([Recording(healthy)]))
    p = problem.parameters.start(hidden)
    own, fits = cross_validate(problem, p), PartFits(problem, p)
    shared = cross_validate(problem, p, parts=folds_of(problem.recordings), fits=fits)
    assert shared.error == pytest.approx(own.error, rel=1e-9)
    np.testing.assert_allclose(shared.blocks, own.blocks, rtol=1e-6)
    assert fits.are_of(problem, p.copy())
    assert not fits.are_of(problem, p + 1e-9)
