"""What a caller of `chea` may rely on, however the search ends."""

import pickle

import numpy as np
import pytest

from rotorrig.identify.chea.chea import chea
from rotorrig.identify.chea.stopping import StopReason

BOX = [(-5.0, 5.0), (-5.0, 5.0)]


def rastrigin(x: np.ndarray) -> np.ndarray:
    return 20 + (x**2 - 10 * np.cos(2 * np.pi * x)).sum(axis=-1)


class Recorder:
    """A function that remembers where it was called."""

    def __init__(self, fun=rastrigin) -> None:
        self.fun = fun
        self.x: list[np.ndarray] = []
        self.f: list[float] = []

    def __call__(self, x: np.ndarray) -> np.ndarray:
        f = self.fun(x)
        self.x.extend(np.atleast_2d(x).copy())
        self.f.extend(np.atleast_1d(f))
        return f


def run(fun=rastrigin, seed: int = 0, **options):
    return chea(fun, options.pop("bounds", BOX), rng=np.random.default_rng(seed), **options)


@pytest.mark.parametrize("vectorized", [False, True])
def test_nfev_is_the_number_of_points_fun_saw_and_fun_the_least_of_their_values(vectorized: bool) -> None:
    recorder = Recorder()
    result = run(recorder, vectorized=vectorized)
    assert result.nfev == len(recorder.f)
    assert result.fun == min(recorder.f)
    assert result.x.tolist() == recorder.x[int(np.argmin(recorder.f))].tolist()


@pytest.mark.parametrize("vectorized", [False, True])
@pytest.mark.parametrize("budget", [1, 2, 199, 200, 201, 640, 901, 1300])
def test_no_budget_is_ever_exceeded(budget: int, vectorized: bool) -> None:
    recorder = Recorder()
    result = run(recorder, max_nfev=budget, vectorized=vectorized)
    assert len(recorder.f) == result.nfev == budget
    assert result.stop_reason is StopReason.BUDGET
    assert not result.success
    assert result.fun == min(recorder.f)


def test_vectorised_or_not_the_search_is_the_same() -> None:
    one, many = Recorder(), Recorder()
    run(one, max_nfev=1500)
    run(many, max_nfev=1500, vectorized=True)
    assert np.array(one.x) == pytest.approx(np.array(many.x), abs=1e-9)


def test_the_same_generator_repeats_the_search_and_another_does_not() -> None:
    first, again, other = (run(seed=seed, vectorized=True) for seed in (4, 4, 5))
    assert first.xl.tolist() == again.xl.tolist()
    assert first.nfev == again.nfev
    assert first.history.tolist() != other.history.tolist()


def test_the_bounds_are_never_left_even_with_the_minimum_on_one() -> None:
    bounds = [(0.1, 0.7), (1e-3, 1e2)]
    recorder = Recorder(lambda x: (x[0] - 2) ** 2 + (np.log(x[1]) + 20) ** 2)
    result = run(recorder, bounds=bounds, x_scale=["linear", "log"])
    assert (np.array(recorder.x) >= [0.1, 1e-3]).all()
    assert (np.array(recorder.x) <= [0.7, 1e2]).all()
    assert result.x == pytest.approx([0.7, 1e-3], rel=1e-9)


def test_the_unit_of_the_objective_does_not_matter() -> None:
    metres = run(seed=3)
    tiny = run(lambda x: rastrigin(x) * 2.0**-60, seed=3)  # a power of two: every float keeps its digits
    assert tiny.xl.tolist() == metres.xl.tolist()
    assert tiny.nfev == metres.nfev


def test_moving_the_box_with_the_function_moves_the_result() -> None:
    shift = np.array([64.0, -32.0])
    here = run(seed=2)
    there = run(lambda x: rastrigin(x - shift), seed=2, bounds=(np.array(BOX) + shift[:, None]))
    assert there.x - shift == pytest.approx(here.x, abs=1e-4)


def test_history_falls_and_ends_at_the_best() -> None:
    result = run()
    calls, best = result.history.T
    assert (np.diff(calls) > 0).all()
    assert (np.diff(best) < 0).all()
    assert best[-1] == result.fun
    assert calls[-1] <= result.nfev


def test_minima_are_listed_best_first_and_are_minima() -> None:
    results = [run(seed=seed, vectorized=True) for seed in range(4)]
    for result in results:
        assert (np.diff(result.funl) >= 0).all()
        assert rastrigin(result.xl).tolist() == pytest.approx(result.funl.tolist(), abs=1e-9)
    listed = np.concatenate([result.xl for result in results])
    assert len(listed) > 8
    inner = listed[(np.abs(listed) < 4.6).all(axis=1)]
    # Rastrigin's minima solve x + 10 pi sin(2 pi x) = 0, so lie within 0.5 % of the whole numbers
    assert np.abs(inner - np.round(inner)).max() < 0.03


def test_target_ends_the_search_with_success() -> None:
    recorder = Recorder()
    result = run(recorder, f_target=1.5)
    assert result.stop_reason is StopReason.TARGET
    assert result.success
    assert recorder.f[-1] <= 1.5 < min(recorder.f[:-1])


def test_ctrl_c_returns_the_best_so_far() -> None:
    recorder = Recorder()

    def interrupted(x: np.ndarray) -> float:
        if len(recorder.f) == 800:
            raise KeyboardInterrupt
        return recorder(x)

    result = run(interrupted)
    assert result.stop_reason is StopReason.INTERRUPTED
    assert not result.success
    assert result.fun == min(recorder.f)
    assert result.nfev == 801  # the call that was cut short began


def test_the_callback_sees_the_best_fall_and_all_three_stages() -> None:
    seen = []
    result = run(callback=seen.append)
    assert {shown.stage for shown in seen} == {"genetic", "local", "far"}
    assert [shown.nit for shown in seen] == list(range(1, result.nit + 1))
    assert (np.diff([shown.fun for shown in seen]) <= 0).all()
    assert seen[-1].fun == result.fun
    assert rastrigin(seen[0].x) == seen[0].fun


@pytest.mark.parametrize("stage", ["genetic", "local"])
def test_the_callback_can_stop_the_search(stage: str) -> None:
    def stop(intermediate_result) -> None:
        if intermediate_result.stage == stage:
            raise StopIteration

    result = run(callback=stop)
    assert result.stop_reason is StopReason.CALLBACK
    assert not result.success
    assert len(result.xl) == (1 if stage == "local" else 0)
    assert np.isfinite(result.fun)


def test_an_error_of_the_callback_itself_reaches_the_caller() -> None:
    with pytest.raises(ZeroDivisionError):
        run(callback=lambda shown: 1 / 0)


@pytest.mark.parametrize("failure", [np.nan, np.inf, ArithmeticError("singular")])
def test_a_function_that_fails_on_half_the_box_is_still_minimised(failure: object) -> None:
    failed = []

    def fragile(x: np.ndarray) -> object:
        if x[0] > 1:
            failed.append(x)
            if isinstance(failure, Exception):
                raise failure
            return failure
        return (x[0] + 2) ** 2 + (x[1] - 1) ** 2

    result = run(fragile)
    assert result.x == pytest.approx([-2, 1], abs=1e-3)
    assert result.success
    assert result.nfail == len(failed) > 0
    assert f"failed at {len(failed)} of the points" in result.message


def test_a_function_that_always_fails_ends_after_the_first_generation() -> None:
    result = run(lambda x: {}["kxx"])
    assert result.stop_reason is StopReason.NO_FINITE_VALUE
    assert (result.nfev, result.nfail, len(result.xl)) == (200, 200, 0)
    assert not result.success
    assert np.isnan(result.x).all()
    assert "KeyError: 'kxx'" in result.message


def test_a_flat_function_does_no_harm() -> None:
    assert run(lambda x: 7.0, max_nfev=1000).fun == 7.0


def test_one_parameter_is_enough() -> None:
    result = run(lambda x: (x[0] - 1) ** 2, bounds=[(-5, 5)])
    assert result.x == pytest.approx([1.0], abs=1e-4)


def test_a_budget_of_nothing_is_refused() -> None:
    with pytest.raises(ValueError, match="max_nfev is 0, expected at least 1"):
        run(max_nfev=0)


def test_status_is_zero_only_for_the_ordinary_end() -> None:
    assert StopReason.CONVERGED.status == 0
    assert len({reason.status for reason in StopReason}) == len(StopReason)


def test_the_result_survives_pickling() -> None:
    result = run(max_nfev=300)
    copy = pickle.loads(pickle.dumps(result))
    assert copy.x.tolist() == result.x.tolist()
    assert copy.stop_reason is StopReason.BUDGET
