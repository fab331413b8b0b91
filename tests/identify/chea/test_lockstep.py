"""Parts of a search side by side."""

import numpy as np

from rotorrig.identify.chea.lockstep import in_lockstep
from rotorrig.identify.chea.session.record import Evaluations


def asks(name: str, sizes: list[int]) -> Evaluations[tuple[str, list[float]]]:
    """Ask for batches of these sizes, of points numbered by part and round; return the name and all values sent."""
    sent: list[float] = []
    for turn, size in enumerate(sizes):
        values = yield np.full((size, 1), 10.0 * ord(name) + turn)
        assert len(values) == size
        sent += values.tolist()
    return name, sent


def drive(part: Evaluations) -> tuple[object, list[int]]:
    """Answer every point by itself; return the finding and the sizes of the batches."""
    sizes: list[int] = []
    try:
        points = next(part)
        while True:
            sizes.append(len(points))
            points = part.send(points[:, 0])
    except StopIteration as end:
        return end.value, sizes


def test_every_part_gets_its_own_values_in_as_many_rounds_as_the_longest_takes() -> None:
    plans = {"a": [2, 1], "b": [1, 3, 2], "c": [1]}
    found, sizes = drive(in_lockstep([asks(name, plan) for name, plan in plans.items()]))
    assert found == [drive(asks(name, plan))[0] for name, plan in plans.items()]
    assert sizes == [4, 4, 2]


def test_findings_come_in_the_order_of_the_parts_not_of_their_ends() -> None:
    found, _ = drive(in_lockstep([asks("a", [1, 1, 1]), asks("b", [1])]))
    assert [name for name, _ in found] == ["a", "b"]


def test_a_part_that_asks_nothing_is_done_at_once() -> None:
    found, sizes = drive(in_lockstep([asks("a", []), asks("b", [2])]))
    assert found == [("a", []), ("b", [980.0, 980.0])]
    assert sizes == [2]


def test_an_empty_request_is_answered_emptily() -> None:
    found, sizes = drive(in_lockstep([asks("a", [0, 1]), asks("b", [2])]))
    assert found[0] == ("a", [971.0])
    assert sizes == [2, 1]


def test_no_parts_at_all_ask_nothing_and_find_nothing() -> None:
    assert drive(in_lockstep([])) == ([], [])


def test_one_within_another_is_as_good() -> None:
    inner = in_lockstep([asks("a", [1, 2]), asks("b", [1])])
    found, sizes = drive(in_lockstep([inner, asks("c", [3, 1, 1])]))
    assert found == [[("a", [970.0, 971.0, 971.0]), ("b", [980.0])], ("c", [990.0] * 3 + [991.0, 992.0])]
    assert sizes == [5, 3, 1]
