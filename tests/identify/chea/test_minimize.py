"""What a caller of `chea` may rely on, whichever profile searches and however the search ends."""

import pickle
from collections.abc import Iterator

import numpy as np
import pytest

from rotorrig.identify.chea import CheaResult, StopReason, chea

BOX = [(-5.0, 5.0), (-5.0, 5.0)]

pytestmark = pytest.mark.parametrize("profile", ["seed", "modern"])


def rastrigin(x: np.ndarray) -> np.ndarray:
    return 20 + (x**2 - 10 * np.cos(2 * np.pi * x)).sum(axis=-1)


def bowl(x: np.ndarray) -> np.ndarray:
    """Zero at (-2, 1)."""
    return (x[..., 0] + 2) ** 2 + (x[..., 1] - 1) ** 2


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


def run(fun=rastrigin, *, profile: str, seed: int = 0, bounds=BOX, **options) -> CheaResult:
    return chea(fun, bounds, rng=np.random.default_rng(seed), profile=profile, **options)


def budgets(natural: int) -> Iterator[int]:
    """Some budgets below the calls a search takes by itself, the last batch's among them."""
    yield from (1, 2)
    yield from np.random.default_rng(0).integers(3, natural - 3, 5).tolist()
    yield from range(natural - 3, natural)


@pytest.mark.parametrize("vectorized", [False, True])
def test_nfev_is_the_number_of_points_fun_saw_and_fun_the_least_of_their_values(profile, vectorized) -> None:
    recorder = Recorder()
    result = run(recorder, profile=profile, vectorized=vectorized)
    assert result.stop_reason is StopReason.CONVERGED
    assert result.nfev == len(recorder.f)
    assert result.fun == min(recorder.f)
    assert result.x.tolist() == recorder.x[int(np.argmin(recorder.f))].tolist()


@pytest.mark.parametrize("vectorized", [False, True])
def test_no_budget_is_exceeded_not_even_by_a_gradient(profile: str, vectorized: bool) -> None:
    natural = run(bowl, profile=profile).nfev
    for budget in budgets(natural):
        recorder = Recorder(bowl)
        result = run(recorder, profile=profile, max_nfev=budget, vectorized=vectorized)
        assert len(recorder.f) == result.nfev == budget
        assert result.stop_reason is StopReason.BUDGET
        assert not result.success
        assert result.fun == min(recorder.f)


def test_a_budget_just_large_enough_is_no_reason_to_stop(profile: str) -> None:
    natural = run(bowl, profile=profile)
    exactly = run(bowl, profile=profile, max_nfev=natural.nfev)
    assert exactly.stop_reason is natural.stop_reason is StopReason.CONVERGED


def test_a_budget_of_nothing_is_refused(profile: str) -> None:
    with pytest.raises(ValueError, match="max_nfev is 0, expected at least 1"):
        run(profile=profile, max_nfev=0)


def test_history_falls_and_ends_at_the_best(profile: str) -> None:
    recorder = Recorder()
    result = run(recorder, profile=profile)
    calls, best = result.history.T
    assert best.tolist() == [recorder.f[int(n) - 1] for n in calls]
    assert (np.diff(calls) > 0).all()
    assert (np.diff(best) < 0).all()
    assert best[-1] == result.fun


def test_the_bounds_are_never_left_even_with_the_minimum_on_one(profile: str) -> None:
    recorder = Recorder(lambda x: (x[0] - 2) ** 2 + (np.log(x[1]) + 20) ** 2)
    result = run(recorder, profile=profile, bounds=[(0.1, 0.7), (1e-3, 1e2)], x_scale=["linear", "log"])
    assert (np.array(recorder.x) >= [0.1, 1e-3]).all()
    assert (np.array(recorder.x) <= [0.7, 1e2]).all()
    assert result.x == pytest.approx([0.7, 1e-3], rel=1e-9)


def test_the_same_generator_repeats_the_search_and_another_does_not(profile: str) -> None:
    first, again, other = (run(profile=profile, seed=seed, vectorized=True, max_nfev=600) for seed in (4, 4, 5))
    assert first.xl.tolist() == again.xl.tolist()
    assert first.nfev == again.nfev
    assert first.history.tolist() != other.history.tolist()


def test_a_seed_serves_as_a_generator_and_a_generator_used_twice_searches_twice(profile: str) -> None:
    def search(rng: np.random.Generator | int) -> CheaResult:
        return chea(rastrigin, BOX, rng=rng, profile=profile, vectorized=True, max_nfev=300)

    rng = np.random.default_rng(7)
    first, second = search(rng), search(rng)
    assert search(7).history.tolist() == first.history.tolist()
    assert second.history.tolist() != first.history.tolist()


def test_the_unit_of_the_objective_does_not_matter(profile: str) -> None:
    metres = run(profile=profile, seed=3)
    tiny = run(lambda x: rastrigin(x) * 2.0**-60, profile=profile, seed=3)  # a power of two: all digits are kept
    assert tiny.xl.tolist() == metres.xl.tolist()
    assert tiny.nfev == metres.nfev


def test_moving_the_box_with_the_function_moves_the_result(profile: str) -> None:
    shift = np.array([64.0, -32.0])
    moved = run(lambda x: bowl(x - shift), profile=profile, bounds=np.array(BOX) + shift[:, None])
    assert moved.x - shift == pytest.approx([-2, 1], abs=1e-4)


@pytest.mark.parametrize("dim", [1, 7])
def test_one_parameter_is_enough_and_seven_are_not_too_many(profile: str, dim: int) -> None:
    middle = np.linspace(-0.8, 0.9, dim)
    result = run(lambda x: ((x - middle) ** 2).sum(axis=1), profile=profile, bounds=[(-1, 1)] * dim, vectorized=True)
    assert result.x == pytest.approx(middle, abs=1e-3)


def test_a_flat_function_does_no_harm(profile: str) -> None:
    assert run(lambda x: 7.0, profile=profile, max_nfev=700).fun == 7.0


def test_minima_are_listed_once_best_first_with_their_exact_values(profile: str) -> None:
    result = run(profile=profile)
    assert len(result.xl) > 1
    assert result.funl.tolist() == [rastrigin(x) for x in result.xl]
    assert (np.diff(result.funl) >= 0).all()
    assert (result.hits >= 1).all()
    apart = np.abs(result.xl[:, None] - result.xl).max(axis=2) + 9 * np.eye(len(result.xl))
    assert apart.min() > 0.01


def test_minima_are_minima(profile: str) -> None:
    listed = np.concatenate([run(profile=profile, seed=seed, vectorized=True).xl for seed in range(2)])
    inner = listed[(np.abs(listed) < 4.6).all(axis=1)]
    # Rastrigin's minima solve x + 10 pi sin(2 pi x) = 0, so lie within 0.5 % of the whole numbers
    assert len(inner) > 4
    assert np.abs(inner - np.round(inner)).max() < 0.03


def test_a_search_cut_short_lists_the_minima_found_until_then(profile: str) -> None:
    whole = run(profile=profile)
    cut = run(profile=profile, max_nfev=whole.nfev - 1)
    assert not cut.success
    assert 0 < len(cut.xl) <= len(whole.xl)
    assert len(cut.xl) == len(cut.funl) == len(cut.hits)
    assert {tuple(x) for x in cut.xl.round(3)} <= {tuple(x) for x in whole.xl.round(3)}


def test_the_target_ends_the_search_with_success_at_the_very_call_that_meets_it(profile: str) -> None:
    recorder = Recorder()
    result = run(recorder, profile=profile, f_target=5.0)
    assert result.stop_reason is StopReason.TARGET
    assert result.success
    assert recorder.f[-1] <= 5.0 < min(recorder.f[:-1])


def test_ctrl_c_returns_the_best_so_far(profile: str) -> None:
    recorder = Recorder()

    def interrupted(x: np.ndarray) -> float:
        if len(recorder.f) == 70:
            raise KeyboardInterrupt
        return recorder(x)

    result = run(interrupted, profile=profile)
    assert result.stop_reason is StopReason.INTERRUPTED
    assert not result.success
    assert result.fun == min(recorder.f)
    assert result.nfev == 70  # the call that was cut short gave no value


def test_status_is_zero_only_for_the_natural_end(profile: str) -> None:
    assert run(bowl, profile=profile).status == 0
    assert run(bowl, profile=profile, max_nfev=9).status != 0
    assert len({reason.status for reason in StopReason}) == len(StopReason)


def test_the_message_counts_in_words(profile: str) -> None:
    assert run(profile=profile, max_nfev=1).message == "Evaluation budget used up after 1 evaluation, 0 minima found."
    found = run(bowl, profile=profile)
    assert found.message == f"Converged after {found.nfev} evaluations, 1 minimum found."


def test_the_result_survives_pickling(profile: str) -> None:
    result = run(profile=profile, max_nfev=50)
    copy = pickle.loads(pickle.dumps(result))
    assert copy.x.tolist() == result.x.tolist()
    assert copy.stop_reason is StopReason.BUDGET


def test_a_printed_result_is_short(profile: str) -> None:
    assert f"SearchState(profile='{profile}', dim=2, nfev=60)" in str(run(profile=profile, max_nfev=60))


def test_the_callback_sees_every_step_of_the_best(profile: str) -> None:
    seen = []
    result = run(profile=profile, callback=seen.append)
    assert len(seen) > 3
    assert (np.diff([shown.nit for shown in seen]) > 0).all()
    assert (np.diff([shown.nfev for shown in seen]) >= 0).all()
    assert (np.diff([shown.fun for shown in seen]) <= 0).all()
    assert all(shown.stage and shown.fun == rastrigin(shown.x) for shown in seen)
    assert (seen[-1].fun, seen[-1].nit) == (result.fun, result.nit)


def test_the_callback_may_take_the_keyword_of_scipy(profile: str) -> None:
    seen = []

    def callback(*, intermediate_result) -> None:
        seen.append(intermediate_result.fun)

    run(bowl, profile=profile, callback=callback)
    assert seen


def test_the_callback_can_stop_the_search_and_was_shown_its_last_state(profile: str) -> None:
    seen = []

    def stop(intermediate_result) -> None:
        seen.append(intermediate_result)
        if len(seen) == 3:
            raise StopIteration

    result = run(profile=profile, callback=stop)
    assert result.stop_reason is StopReason.CALLBACK
    assert not result.success
    assert (result.nfev, result.nit, result.fun) == (seen[2].nfev, seen[2].nit, seen[2].fun)


def test_an_error_of_the_callback_itself_reaches_the_caller(profile: str) -> None:
    with pytest.raises(ZeroDivisionError):
        run(profile=profile, callback=lambda shown: 1 / 0)


def test_watching_changes_nothing(profile: str) -> None:
    watched = run(profile=profile, max_nfev=600, callback=lambda shown: None)
    assert watched.history.tolist() == run(profile=profile, max_nfev=600).history.tolist()


@pytest.mark.parametrize("failure", [np.nan, np.inf, -np.inf, ArithmeticError("singular")])
def test_a_function_that_fails_on_part_of_the_box_is_still_minimised(profile: str, failure: object) -> None:
    failed = []

    def fragile(x: np.ndarray) -> object:
        if x[0] > 1:
            failed.append(x)
            if isinstance(failure, Exception):
                raise failure
            return failure
        return bowl(x)

    result = run(fragile, profile=profile)
    assert result.x == pytest.approx([-2, 1], abs=1e-3)
    assert result.success
    assert result.nfail == len(failed) > 1
    why = "ArithmeticError: singular" if isinstance(failure, Exception) else f"fun returned {failure}"
    assert result.message.endswith(f"fun failed at {len(failed)} points, at first with: {why}.")


def test_a_vectorised_function_fails_where_it_says_so(profile: str) -> None:
    result = run(lambda x: np.where(x[:, 0] > 1, np.nan, bowl(x)), profile=profile, vectorized=True)
    assert result.x == pytest.approx([-2, 1], abs=1e-3)
    assert result.nfail > 1


def test_a_function_that_always_fails_ends_the_search_early_and_says_why(profile: str) -> None:
    result = run(lambda x: {}["kxx"], profile=profile)
    assert result.stop_reason is StopReason.NO_FINITE_VALUE
    assert result.nfev == result.nfail <= 200
    assert len(result.xl) == 0
    assert not result.success
    assert np.isnan(result.x).all()
    assert "KeyError: 'kxx'" in result.message


def test_what_is_no_number_is_refused_at_the_first_call(profile: str) -> None:
    recorder = Recorder(lambda x: "1.0")
    with pytest.raises(TypeError, match=r"expected 1 real number$"):
        run(recorder, profile=profile)
    assert len(recorder.f) == 1


def test_bounds_or_a_search_to_resume_but_not_both(profile: str) -> None:
    state = run(profile=profile, max_nfev=5).state
    with pytest.raises(ValueError, match="bounds and resume were not given, expected one of them"):
        chea(rastrigin, profile=profile)
    with pytest.raises(ValueError, match="bounds and resume were both given, expected one of them"):
        chea(rastrigin, BOX, profile=profile, resume=state)
