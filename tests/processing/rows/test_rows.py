"""Where rows are laid: by turns, by steps of speed and by steps of time, and never over each other."""

from collections.abc import Callable

import numpy as np
import pytest

from rotorrig.acquisition.recording import RawRecording
from rotorrig.processing.pipeline import track
from rotorrig.processing.rows.rows import Rows, crowded_share, lay_rows
from rotorrig.processing.settings import Spacing, Tracking
from rotorrig.processing.shaft_angle.shaft_angle import TURN, ShaftAngle, fit_shaft_angle
from tests.processing.synthetic import chirp

RPM = np.pi / 30
TURNS = 8
LOW, HIGH, RISE = 600 * RPM, 1800 * RPM, 40 * RPM  # up in 30 s, then down in 30 s


@pytest.fixture(scope="module")
def shaft() -> ShaftAngle:
    up = np.arange(0, (HIGH**2 - LOW**2) / (2 * RISE), TURN)
    rising = (np.sqrt(LOW**2 + 2 * RISE * up) - LOW) / RISE
    return fit_shaft_angle(
        np.concatenate([rising, 60 - rising[::-1]])
    )  # the top is a turn and a bit away on either side


UP_DOWN = [(0.0, 29.5), (30.5, 60.0)]


def assert_apart(rows: Rows) -> None:
    same = rows.run[1:] == rows.run[:-1]
    assert (np.diff(rows.first_turn)[same] >= rows.turns).all()


def test_rows_follow_on_one_another_from_edge_to_edge(shaft: ShaftAngle) -> None:
    rows = lay_rows(shaft, UP_DOWN, turns=TURNS)
    for run, (begin, end) in enumerate(UP_DOWN):
        mine = rows.run == run
        assert set(np.diff(rows.first_turn[mine])) == {TURNS}
        assert rows.begin[mine].min() >= begin
        assert rows.end[mine].max() <= end
    np.testing.assert_array_equal(rows.first_turn, np.round(rows.first_turn))


def test_steps_of_speed_give_both_runs_the_same_speeds(shaft: ShaftAngle) -> None:
    rows = lay_rows(shaft, UP_DOWN, turns=TURNS, every=[Spacing(of="speed", step=50 * RPM)] * 2)
    up, down = (rows.omega[rows.run == run] / RPM for run in (0, 1))
    np.testing.assert_allclose(up, np.arange(650, 1751, 50), atol=0.02)  # 600 and 1800 are less than half a row away
    np.testing.assert_allclose(down, np.arange(1750, 649, -50), atol=0.02)
    assert_apart(rows)


def test_steps_of_time_stand_on_the_recordings_clock(shaft: ShaftAngle) -> None:
    rows = lay_rows(shaft, UP_DOWN, turns=TURNS, every=[Spacing(of="time", step=2.0)] * 2)
    np.testing.assert_allclose(rows.t, [*np.arange(2, 29, 2), *np.arange(32, 59, 2)], atol=1e-6)


def test_steps_shorter_than_a_row_leave_rows_that_do_not_overlap(shaft: ShaftAngle) -> None:
    dense = lay_rows(shaft, UP_DOWN, turns=TURNS, every=[Spacing(of="speed", step=2 * RPM)] * 2)
    assert_apart(dense)
    whole = lay_rows(shaft, UP_DOWN, turns=TURNS)
    assert 0.85 * len(whole.t) < len(dense.t) <= len(whole.t)


def test_a_speed_that_hunts_gives_one_row_to_each_step() -> None:
    t = np.arange(0, 60, 1e-3)
    theta = 90 * t + t**2 / 4 + 2 * np.sin(2 * t)  # turns back by 4 of its 30 rad/s, again and again
    hunting = fit_shaft_angle(np.interp(TURN * np.arange(int(theta[-1] / TURN)), theta, t))
    step = 2.0
    rows = lay_rows(hunting, [(0.0, 60.0)], turns=4, every=[Spacing(of="speed", step=step)])
    multiple = rows.omega / step
    np.testing.assert_allclose(multiple, np.round(multiple), atol=0.02)
    assert len(set(np.round(multiple))) == len(multiple)


def test_an_empty_span_has_no_rows(shaft: ShaftAngle) -> None:
    for every in (None, Spacing(of="speed", step=RPM), Spacing(of="time", step=1.0)):
        assert len(lay_rows(shaft, [(70.0, 80.0), (1.0, 1.1)], turns=TURNS, every=[every] * 2).t) == 0


def test_rows_further_apart_than_asked_for_are_counted(record: Callable[..., RawRecording]) -> None:
    rate = 4_000.0
    t = np.arange(int(30 * rate)) / rate
    theta = chirp(t, start=600 * RPM, rate=20 * RPM, theta_0=-0.3)
    x = np.tile(20e-6 * np.cos(theta)[:, None], 4) + 1e-8 * np.random.default_rng(5).standard_normal((len(t), 4))
    recording = record(theta, x, rate=rate, marks=[(0.0, "up")])
    wide, narrow = (Spacing(of="speed", step=step * RPM) for step in (30, 5))  # a row takes 0.8 s and 16 rpm at first
    assert crowded_share(track(recording, Tracking(every=wide)), wide) == 0
    assert crowded_share(track(recording, Tracking(every=narrow)), narrow) > 0.9
    dwell = record(theta, x, rate=rate, marks=[(0.0, "dwell")])
    assert crowded_share(track(dwell, Tracking(every=narrow)), narrow) == 0  # no steps of speed are kept there
