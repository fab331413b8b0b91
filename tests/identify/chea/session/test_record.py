"""The record: every point and value, the best, failures."""

import numpy as np
import pytest

from rotorrig.identify.chea.session.record import Record

FIVE = np.array([[0.5, 0.1], [0.4, 0.1], [0.6, 0.1], [0.2, 0.1], [0.3, 0.1]])


@pytest.fixture
def record() -> Record:
    return Record(2, same_point=0.01)


@pytest.mark.parametrize("portions", [[5], [1, 1, 1, 1, 1], [2, 0, 3]])
def test_values_best_and_history_do_not_depend_on_the_portions(record: Record, portions: list[int]) -> None:
    ends = np.cumsum(portions)[:-1]
    for u, f in zip(np.split(FIVE, ends), np.split(10 * FIVE[:, 0], ends), strict=True):
        record.add(u, f)
    assert record.nfev == 5
    assert record.points.tolist() == FIVE.tolist()
    assert record.values.tolist() == [5, 4, 6, 2, 3]
    assert record.best[0].tolist() == [0.2, 0.1]
    assert record.best[1] == 2
    assert record.history == [(1, 5), (2, 4), (4, 2)]


def test_a_value_met_again_is_no_improvement(record: Record) -> None:
    record.add(FIVE, np.ones(5))
    assert record.history == [(1, 1.0)]
    assert record.best[0].tolist() == [0.5, 0.1]


def test_failures_are_counted_and_plus_infinity(record: Record) -> None:
    record.add(FIVE, np.array([np.nan, np.inf, -np.inf, 1.0, np.nan]))
    assert record.values.tolist() == [np.inf, np.inf, np.inf, 1.0, np.inf]
    assert (record.nfev, record.failures) == (5, 4)
    assert record.best[1] == 1.0


def test_before_the_first_value_there_is_no_best(record: Record) -> None:
    for _ in range(2):
        point, value = record.best
        assert np.isnan(point).all()
        assert value == np.inf
        record.add(FIVE[:1], np.array([np.nan]))
    assert record.history == []


def test_more_points_than_the_first_page_are_kept(record: Record) -> None:
    u = np.random.default_rng(0).random((5000, 2))
    for part in np.split(u, [3, 1700]):
        record.add(part, part[:, 0])
    assert record.points.tolist() == u.tolist()
    assert record.values.tolist() == u[:, 0].tolist()


def test_a_part_of_the_search_cannot_change_what_was_evaluated(record: Record) -> None:
    record.add(FIVE, FIVE[:, 0])
    for view in (record.points, record.values, record.best[0]):
        with pytest.raises(ValueError, match="read-only"):
            view += 1
    record.add(FIVE, FIVE[:, 0])  # the record itself can go on


def test_steps_are_counted_and_the_latest_is_named(record: Record) -> None:
    record.step("genetic")
    record.step("local")
    assert (record.nit, record.stage) == (2, "local")


@pytest.mark.parametrize("count", [30, 4096, 4500, 9500])
def test_the_nearest_points_are_the_same_however_many_there_are(count: int) -> None:
    rng = np.random.default_rng(count)
    points, record = rng.random((count, 3)), Record(3)
    for part in np.array_split(points, 7):
        record.add(part, np.zeros(len(part)))
        record.nearest(rng.random(3), 40)  # whatever was asked before
    for u in rng.random((5, 3)):
        away = np.linalg.norm(points - u, axis=1)
        found = record.nearest(u, 40)
        assert sorted(away[found]) == pytest.approx(np.sort(away)[:40])
        assert len(set(found.tolist())) == min(40, count)
