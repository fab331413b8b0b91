"""The ledger: every call counted, the budget kept, failures reported."""

import numpy as np
import pytest

from rotorrig.identify.chea.ledger import Ledger
from rotorrig.identify.chea.scaling import from_bounds
from rotorrig.identify.chea.stopping import Halt, StopReason

PLANE = from_bounds([(0.0, 10.0), (0.0, 10.0)], "linear")
FIVE = np.array([[0.5, 0.1], [0.4, 0.1], [0.6, 0.1], [0.2, 0.1], [0.3, 0.1]])  # first parameter 5, 4, 6, 2, 3


def first(x: np.ndarray) -> float:
    return x[..., 0]


@pytest.mark.parametrize("vectorized", [False, True])
def test_values_best_and_history_follow_the_order_of_calls(vectorized: bool) -> None:
    ledger = Ledger(first, PLANE, max_nfev=99, vectorized=vectorized)
    assert ledger.evaluate(FIVE) == pytest.approx([5, 4, 6, 2, 3])
    assert ledger.nfev == 5
    assert ledger.best_x == pytest.approx([2, 1])
    assert [n for n, _ in ledger.history] == [1, 2, 4]
    assert [f for _, f in ledger.history] == pytest.approx([5, 4, 2])
    assert ledger.points.tolist() == FIVE.tolist()


@pytest.mark.parametrize("vectorized", [False, True])
def test_the_budget_is_used_up_and_not_exceeded(vectorized: bool) -> None:
    asked = []

    def counting(x: np.ndarray) -> np.ndarray:
        asked.extend(np.atleast_2d(x))
        return first(x)

    ledger = Ledger(counting, PLANE, max_nfev=3, vectorized=vectorized)
    with pytest.raises(Halt) as halt:
        ledger.evaluate(FIVE)
    assert halt.value.reason is StopReason.BUDGET
    assert ledger.nfev == len(asked) == 3
    assert ledger.best_fun == pytest.approx(4.0)
    with pytest.raises(Halt):
        ledger.evaluate(FIVE[:1])
    assert len(asked) == 3


def test_a_budget_met_exactly_stops_nothing_yet() -> None:
    assert len(Ledger(first, PLANE, max_nfev=5).evaluate(FIVE)) == 5


def test_the_target_stops_at_the_very_call_that_meets_it() -> None:
    ledger = Ledger(first, PLANE, max_nfev=99, f_target=4.0)
    with pytest.raises(Halt) as halt:
        ledger.evaluate(FIVE)
    assert halt.value.reason is StopReason.TARGET
    assert ledger.nfev == 2


def test_failures_are_plus_infinity_counted_and_the_first_is_told() -> None:
    def fragile(x: np.ndarray) -> float:
        if x[0] == pytest.approx(4):
            raise ZeroDivisionError("no shaft")
        return {5: np.nan, 6: -np.inf, 2: np.inf}.get(round(x[0]), 1.0)

    ledger = Ledger(fragile, PLANE, max_nfev=99)
    assert ledger.evaluate(FIVE).tolist() == [np.inf, np.inf, np.inf, np.inf, 1.0]
    assert (ledger.nfev, ledger.failures) == (5, 4)
    assert ledger.first_failure == "fun returned nan"


def test_an_exception_is_told_with_its_type() -> None:
    def broken(x: np.ndarray) -> float:
        raise ZeroDivisionError("no shaft")

    ledger = Ledger(broken, PLANE, max_nfev=99, vectorized=True)
    assert ledger.evaluate(FIVE).tolist() == [np.inf] * 5
    assert ledger.first_failure == "ZeroDivisionError: no shaft"
    assert ledger.failures == 5


@pytest.mark.parametrize("wrong", [None, "1.0", [1.0, 2.0], 1j])
def test_no_number_is_refused_in_a_sentence(wrong: object) -> None:
    with pytest.raises(TypeError, match=r"expected 1 real number$"):
        Ledger(lambda x: wrong, PLANE, max_nfev=9).evaluate(FIVE)


def test_a_vectorised_function_must_give_one_value_per_point() -> None:
    with pytest.raises(TypeError, match=r"shape \(\), expected 5 real numbers"):
        Ledger(lambda x: 1.0, PLANE, max_nfev=9, vectorized=True).evaluate(FIVE)


@pytest.mark.parametrize("vectorized", [False, True])
def test_a_function_that_writes_on_its_argument_harms_nothing(vectorized: bool) -> None:
    def greedy(x: np.ndarray) -> np.ndarray:
        f = first(x).copy()
        x[...] = -1.0
        return f

    ledger = Ledger(greedy, PLANE, max_nfev=99, vectorized=vectorized)
    ledger.evaluate(FIVE)
    assert ledger.best_x == pytest.approx([2, 1])
    assert ledger.points.tolist() == FIVE.tolist()


def test_more_points_than_the_first_page_are_kept() -> None:
    u = np.random.default_rng(0).random((5000, 2))
    ledger = Ledger(first, PLANE, max_nfev=9999, vectorized=True)
    for part in np.split(u, [3, 1700]):
        ledger.evaluate(part)
    assert ledger.points.tolist() == u.tolist()
