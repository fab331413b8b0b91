"""The model's own error: its covariance over speed, what whitens it, and what a fit then says of a wandering probe."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from rotorrig.identify.base_fit import AssessedFit, fit_base
from rotorrig.identify.extended_model.jacobian import vectors_by
from rotorrig.identify.extended_model.known_error import known_error
from rotorrig.identify.extended_model.tracked_recording import Recording
from rotorrig.identify.measurement.model_error import LENGTH, Shrinkage, changed_vectors, error_vectors
from rotorrig.identify.measurement.whitened_rows import measure
from rotorrig.identify.verdict.cross_validation import cross_validate
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.effects.base import find
from rotorrig.sims.effects.shaft_asymmetry import ShaftAsymmetry
from tests.identify.swept import SIGMA, C, K, swept_response
from tests.parameters import defer_rest

SHARE = 0.005
REPEATABILITY = 0.003


def test_the_error_of_one_probe_is_a_share_of_its_motion_and_alike_at_like_speeds() -> None:
    speed = 100 * np.exp(np.array([0.0, 0.05, LENGTH, 2 * LENGTH, 2.0]))
    motion = np.array([[1 + 2j, 5.0], [3.0, 5j], [-4j, 1.0], [2.0, 2.0], [1.0, 7.0]]) * 1e-6
    vectors = error_vectors(motion, speed, np.zeros(5, int), share=SHARE, repeatability=0.0)
    covariance = np.einsum("ipc,jqc->ipjq", vectors, vectors.conj())
    apart = np.log(speed)[:, None] - np.log(speed)
    for probe in range(2):
        z = motion[:, probe]
        alike = 2 * SHARE**2 * np.outer(z, z.conj()) * np.exp(-(apart**2) / (2 * LENGTH**2))
        np.testing.assert_allclose(covariance[:, probe, :, probe], alike, atol=2e-3 * np.abs(alike).max())
    assert np.abs(covariance[:, 0, :, 1]).max() == 0


def test_runs_share_one_part_of_the_error_and_have_another_each_for_itself() -> None:
    speed, run = np.full(4, 200.0), np.array([0, 0, 3, 7])
    motion = np.full((4, 1), 2e-6 + 0j)
    vectors = error_vectors(motion, speed, run, share=SHARE, repeatability=REPEATABILITY)[:, 0]
    covariance = (vectors @ vectors.conj().T).real / (2 * 4e-12)
    same = run[:, None] == run
    np.testing.assert_allclose(covariance, SHARE**2 + REPEATABILITY**2 * same, rtol=2e-3)


def test_a_damping_that_changes_is_the_constant_where_it_tells_and_alike_at_like_speeds() -> None:
    speed = 100 * np.exp(np.array([0.0, LENGTH, 2.0]))
    slopes = np.array([[[1 + 2j], [3.0]], [[5e4j], [1.0]], [[2.0], [-2j]]]) * 1e-6  # (row, probe, damping)
    vectors = changed_vectors(slopes, speed, np.full((3, 2), 1e-7), share=0.1)
    covariance = np.einsum("ipc,jqc->ipjq", vectors, vectors.conj())
    apart = np.log(speed)[:, None] - np.log(speed)
    kernel = np.exp(-(apart**2) / (2 * LENGTH**2))
    change = 0.1**2 * (kernel - kernel[:, 1:2] - kernel[1:2] + 1)  # of the difference from the second, the loudest
    wanted = np.einsum("ip,ij,jq->ipjq", slopes[..., 0], change, slopes[..., 0].conj())
    np.testing.assert_allclose(covariance, wanted, atol=3e-3 * np.abs(wanted[[0, 2]][:, :, [0, 2]]).max())


def test_the_slopes_by_damping_are_those_of_the_prediction(quiet: OrderTrackedResponse) -> None:
    fit = fit_base([Recording(quiet)])
    problem, p = fit.problem, fit.polished.p
    names = problem.parameters.base
    (slopes,) = vectors_by(problem.model, p, names.dampings)
    assert [names.names[i] for i in names.dampings] == ["cxx", "cyy"]
    for column, i in enumerate(names.dampings):
        more, less = p.copy(), p.copy()
        more[i] += 1e-4
        less[i] -= 1e-4
        ratio = names.space.from_working(more[names.sought])[i] / names.space.from_working(less[names.sought])[i]
        (one,), (other,) = (problem.model.predict(q, orders=(1,)) for q in (more, less))
        difference = (one[1] - other[1]) / np.log(ratio)
        np.testing.assert_allclose(slopes[..., column], difference, atol=3e-4 * np.abs(difference).max())


@pytest.mark.parametrize("direction", [0.0, 1.0, 2.5])
def test_a_mark_that_moves_with_the_driven_end_turns_all_vectors_alike(
    quiet: OrderTrackedResponse, direction: float
) -> None:
    """By what the end moves across the keyphasor as the mark is there, over 15 mm: a part of the error known."""
    fit = fit_base([Recording(quiet)])
    model, p = fit.problem.model, fit.polished.p
    (known,), (z,) = known_error(model, p), model.predict(p, orders=(1,))
    end = model.rotor(p).z.tolist().index(0.0)
    across = np.array([-np.sin(direction), np.cos(direction)])
    x, y = model.motion_at(model.recordings[0], p, model.rotor(p).centreline[:, end]).real.T
    lead = (across[0] * x + across[1] * y) / 0.015
    turned = z[1] * np.exp(-1j * lead[:, None])
    assert np.abs(lead).max() > 1e-4
    np.testing.assert_allclose(
        z[1] - known[1][..., -2:] @ across, turned, atol=2 * np.abs(z[1]).max() * lead.max() ** 2
    )


def test_a_force_law_is_known_to_a_tenth_of_what_it_does(quiet: OrderTrackedResponse) -> None:
    base = fit_base([Recording(quiet)])
    bent = base.problem.extended([find(quiet.rig, "cubic_spring")])
    p = np.append(base.polished.p[: base.problem.parameters.own.start], 0.2)  # of a size
    straight = base.problem.extended([])
    (known,), (without,) = (
        [each[1] for each in known_error(*at)] for at in ((bent.model, p), (straight.model, p[:-1]))
    )
    (z,), (plain,) = bent.model.predict(p, orders=(1,)), straight.model.predict(p[:-1], orders=(1,))
    of_law = known[..., without.shape[-1] :]
    deviation = np.sqrt(np.sum(np.abs(of_law) ** 2, axis=-1) / 2)[:-1]
    wanted = 0.1 * np.abs(z[1] - plain[1])[:-1]
    assert wanted.max() > 1e-6
    np.testing.assert_allclose(deviation, wanted, atol=2e-3 * wanted.max())


@pytest.mark.parametrize("over_speed", [0.0, 0.1])
def test_above_1x_a_model_is_known_as_well_as_at_1x(
    quiet: OrderTrackedResponse, over_speed: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By a share of its motion there, and by dampings that are others at another speed; here of a law without error."""
    monkeypatch.setattr(ShaftAsymmetry, "law_error", 0.0)
    prior = quiet.rig.prior.model_copy(update={"damping_over_speed": over_speed})
    response = replace(quiet, rig=quiet.rig.model_copy(update={"prior": prior}))
    base = fit_base([Recording(response)])
    assert base.problem.error_of_effects(base.polished.p) == [{}], "the base does nothing there"
    uneven = base.problem.extended([find(response.rig, "shaft_asymmetry")])
    p = np.append(base.polished.p[: base.problem.parameters.own.start], [0.6, 0.3])  # of a size
    (above,), (z,) = uneven.error_of_effects(p), uneven.model.predict(p)
    assert list(above) == [2], "at 2X alone"
    moved = np.abs(z[2][:-1] - z[2][-1])  # beyond the slow roll
    by_share = np.hypot(prior.model_error, prior.repeatability) * moved
    deviation = np.sqrt(np.sum(np.abs(above[2]) ** 2, axis=-1) / 2)[:-1]
    peak = int(moved[:, 0].argmax())
    if over_speed:
        assert (deviation > 0.97 * by_share).all()
        assert deviation[peak, 0] > 1.05 * by_share[peak, 0]
    else:
        np.testing.assert_allclose(deviation, by_share, rtol=0.03)  # curved probes make 2X of 1X, too
    assert uneven.expecting_error(p).recordings[0].measured[2].error is not None


@pytest.mark.parametrize(
    ("label", "order", "share"),
    [("coupling", 1, 0.0), ("coupling", 2, 0.05), ("shaft_asymmetry", 2, 0.05), ("probe_angle, probe 2x", 1, 0.0)],
)
def test_above_1x_a_law_is_known_to_a_share_of_what_it_does(
    label: str, order: int, share: float, quiet: OrderTrackedResponse, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Beyond what it does to the slow roll, which was measured; what is so by definition is known."""
    base = fit_base([Recording(quiet)])
    effect = find(quiet.rig, label)
    larger = base.problem.extended([effect])
    p, without = (larger.parameters.start(base.polished.p) for _ in range(2))
    p[larger.parameters.own] = 0.7  # of a size, each
    (z,), (plain,) = larger.model.predict(p), larger.model.predict(without)
    (known,) = known_error(larger.model, p)
    monkeypatch.setattr(type(effect), "law_error", 0.0)
    (exact,) = known_error(larger.model, p)
    done = z[order][:-1] - z[order][-1] - (plain[order][:-1] - plain[order][-1])
    added = _variance(known.get(order)) - _variance(exact.get(order))
    assert np.abs(done).max() > 1e-7
    np.testing.assert_allclose(added, (share * np.abs(done)) ** 2, atol=0.01 * np.abs(share * done).max() ** 2)


def _variance(vectors: NDArray[np.complex128] | None) -> NDArray[np.float64] | float:
    """Return that of either part of the error, (row, probe)."""
    return 0.0 if vectors is None else np.sum(np.abs(vectors[:-1]) ** 2, axis=-1) / 2


def test_noise_and_error_together_come_out_white(blind_response: OrderTrackedResponse) -> None:
    model = np.nan_to_num(blind_response.z[..., blind_response.orders.index(1.0)])
    measured = measure(blind_response)
    predicted = np.concatenate([model[measured.rows], measured.z[-1:]])
    both = measured.expecting_error(predicted, _expecting(blind_response, SHARE))
    rng = np.random.default_rng(0)
    drawn = [both.sigmas(both.noise(rng)) for _ in range(200)]
    assert np.std(drawn) == pytest.approx(1.0, abs=0.01)
    plain = [measured.sigmas(both.noise(rng))[:-1].std() for _ in range(20)]
    assert np.mean(plain) > 1.5  # in the noise alone they are not
    assert both.taken_for_exact().shrinkage is None


def test_what_may_be_the_models_error_leaves_the_figures_that_are_none() -> None:
    rng = np.random.default_rng(1)
    error = rng.standard_normal((40, 3)) * 5
    white = Shrinkage.of(error)
    covariance = np.eye(40) + error @ error.T
    whole = white(np.eye(40))
    np.testing.assert_allclose(whole @ covariance @ whole, np.eye(40), atol=1e-12)
    other = rng.standard_normal(40)
    other -= error @ np.linalg.lstsq(error, other, rcond=None)[0]
    np.testing.assert_allclose(white(other), other, atol=1e-12)


def test_rows_left_out_have_no_part_in_it(blind_response: OrderTrackedResponse) -> None:
    expecting = _expecting(blind_response, SHARE)
    recording = Recording(expecting)
    model = {1: recording.measured[1].z}
    some = np.arange(len(recording.rows)) % 3 == 0
    for order in (1, 2):
        shown = recording.expecting_error(model).only(some).measured[order]
        off = np.where(shown.usable, 1e-6 + 0j, 0)
        assert (shown.sigmas(off)[:-1][~some] == 0).all()
        again = recording.only(some).expecting_error(model).measured[order]
        np.testing.assert_allclose(shown.sigmas(off), again.sigmas(off), atol=1e-9)


def test_a_product_of_two_motions_is_expected_at_2x_and_a_steady_force_is_not(
    blind_response: OrderTrackedResponse,
) -> None:
    """A probe that hears its neighbour the more the nearer both are: x y, a square of 1X turned by a right angle."""
    recording = Recording(_expecting(blind_response, 0.01))
    first = np.nan_to_num(recording.measured[1].z)
    expecting = recording.expecting_error({1: first}).measured[2]
    motion = first - first[-1]
    largest = np.abs(motion).max(axis=0)
    product, steady = 5e-4j * motion**2 / largest, np.full_like(motion, 5e-4 * largest.min())
    usable = np.repeat(expecting.usable, 2, axis=1)
    seen, unseen = (np.sqrt(np.mean(expecting.sigmas(z)[usable] ** 2)) for z in (steady, product))
    plain = np.sqrt(np.mean(expecting.row_sigmas(product)[usable] ** 2))
    assert unseen < 0.35 * plain
    assert seen > 0.5 * np.sqrt(np.mean(expecting.row_sigmas(steady)[usable] ** 2))


@pytest.fixture(scope="module")
def quiet(rig: RigConfig) -> OrderTrackedResponse:
    """A run-up and run-down by the model itself, with a tenth of the noise that other tests have."""
    exact = swept_response(rig)
    noise = np.random.default_rng(2).standard_normal((2, *exact.z.shape))
    z = exact.z + SIGMA / 10 * (noise[0] + 1j * noise[1])
    return replace(exact, z=z, covariance=exact.covariance / 100)


@pytest.mark.campaign
def test_a_rig_that_is_its_model_is_fitted_with_the_models_error_or_without(quiet: OrderTrackedResponse) -> None:
    for share in (0.0, SHARE):
        fit = fit_base([Recording(_expecting(quiet, share))])
        assert fit.adequacy.adequate
        assert _errors(fit).max() < 3


@pytest.mark.campaign
@pytest.mark.parametrize("turns", defer_rest([4.0, 8.0]))
def test_where_probes_wander_with_speed_damping_is_wrong_for_a_model_taken_for_exact_and_no_other(
    quiet: OrderTrackedResponse, turns: float
) -> None:
    wandering = _off_by_a_sine(quiet, 0.006, turns=turns)
    exact, expecting = (fit_base([Recording(_expecting(wandering, share))]) for share in (0.0, SHARE))
    assert not exact.adequacy.adequate
    assert _errors(exact).max() > 3
    assert expecting.adequacy.adequate
    assert _errors(expecting).max() < 2


@pytest.mark.campaign
def test_unseen_rows_are_predicted_within_what_noise_and_the_models_error_make_expected(
    quiet: OrderTrackedResponse,
) -> None:
    wandering = _expecting(_off_by_a_sine(quiet, 0.006), SHARE)
    fit = fit_base([Recording(wandering)])
    found = cross_validate(fit.problem, fit.polished.p)
    assert found.over_floor > 1.3
    assert found.over_expected < 1.2
    assert found.sigmas == pytest.approx(1.0, abs=0.25)


def _expecting(response: OrderTrackedResponse, share: float) -> OrderTrackedResponse:
    own = {"model_error": share, "repeatability": share / 2, "harmonic_error": share / 10, "damping_over_speed": 0.0}
    prior = response.rig.prior.model_copy(update=own)
    return replace(response, rig=response.rig.model_copy(update={"prior": prior}))


def _off_by_a_sine(response: OrderTrackedResponse, size: float, *, turns: float = 4.0) -> OrderTrackedResponse:
    """Return 1X with a complex share of its motion added, a sine in the logarithm of speed: no draw of the model's."""
    n = response.orders.index(1.0)
    probes = np.arange(len(response.probes))
    off = size * np.sin(turns * np.log(response.omega)[:, None] + probes) * np.exp(1j * probes)
    z = response.z.copy()
    z[..., n] += off * (z[..., n] - response.slow_roll[:, n])
    return replace(response, z=z)


def _errors(fit: AssessedFit) -> NDArray[np.float64]:
    """Return by how many of its standard deviations each coefficient is off."""
    names = fit.problem.parameters.base
    values = names.values(fit.polished.p[: len(names)])
    sigma = fit.polished.sigma[names.sought] * names.space.slopes(values)
    return np.abs(values - np.array([*K, *C])) / sigma
