"""One call of the objective."""

import numpy as np
import pytest

from rotorrig.identify.chea.calls.call import call

X = np.array([0.5, 2.0])


def test_a_number_of_any_kind_is_its_value() -> None:
    for number in (3, 3.0, np.float32(3), np.array(3), np.array([[3.0]]), [3.0]):
        values, failure = call(lambda x, number=number: number, X, n=1)
        assert values.tolist() == [3.0]
        assert values.dtype == np.float64
        assert failure == ""


def test_one_bad_value_of_a_batch_leaves_the_others_and_names_itself() -> None:
    values, failure = call(lambda x: [1.0, np.inf, np.nan], X, n=3)
    assert values.tolist()[:2] == [1.0, np.inf]
    assert failure == "fun returned inf"


def test_an_exception_is_a_failure_with_its_type_and_words() -> None:
    values, failure = call(lambda x: 1 / 0, X, n=2)
    assert np.isnan(values).all()
    assert len(values) == 2
    assert failure == "ZeroDivisionError: division by zero"


@pytest.mark.parametrize("exception", [KeyboardInterrupt, SystemExit])
def test_what_is_meant_for_the_whole_program_is_no_failure(exception: type[BaseException]) -> None:
    def fun(x: np.ndarray) -> float:
        raise exception

    with pytest.raises(exception):
        call(fun, X, n=1)


@pytest.mark.parametrize("wrong", [None, "1.0", [1.0, 2.0], 1j, [], {}])
def test_what_is_no_number_is_refused_in_a_sentence(wrong: object) -> None:
    with pytest.raises(TypeError, match=r"fun returned .* of shape \(.*\), expected 1 real number$"):
        call(lambda x: wrong, X, n=1)


def test_a_batch_must_give_one_value_per_point() -> None:
    with pytest.raises(TypeError, match=r"fun returned float64 of shape \(\), expected 5 real numbers$"):
        call(lambda x: 1.0, X, n=5)


def test_a_function_that_writes_on_its_argument_harms_nothing() -> None:
    def greedy(x: np.ndarray) -> float:
        x[...] = -1.0
        return 0.0

    call(greedy, X, n=1)
    assert X.tolist() == [0.5, 2.0]
