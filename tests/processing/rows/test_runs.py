"""Runs from marks, and from the speed alone."""

import numpy as np
import pytest

from rotorrig.acquisition.recording import Event
from rotorrig.processing.rows.runs import find_runs
from rotorrig.processing.shaft_angle.shaft_angle import TURN, ShaftAngle, fit_shaft_angle

RPM = np.pi / 30


def shaft_with(profile: list[tuple[float, float]]) -> ShaftAngle:
    """Return the shaft angle of a speed that goes straight between (time [s], speed [rpm])."""
    at, rpm = np.array(profile).T
    t = np.arange(0, at[-1], 1e-3)
    speed = np.interp(t, at, rpm) * RPM
    theta = np.concatenate([[0.0], np.cumsum((speed[1:] + speed[:-1]) / 2 * 1e-3)])
    return fit_shaft_angle(np.interp(TURN * np.arange(int(theta[-1] / TURN)), theta, t))


SWEEP = shaft_with([(0, 240), (12, 240), (22, 480), (82, 2280), (90, 2280), (130, 480)])


def mark(seconds: float, text: str, kind: str = "mark") -> Event:
    return Event(t_ns=round(seconds * 1e9), kind=kind, text=text)


def test_a_run_lasts_from_its_mark_to_the_next() -> None:
    events = [
        mark(0, "settling"),
        mark(2, "slow roll"),
        mark(12, "settling"),
        mark(22, "up"),
        mark(83, "down"),
        mark(129, "end"),
    ]
    found = [(s.run.name, s.run.direction, s.begin, s.end) for s in find_runs(events, SWEEP)]
    assert found == [("slow roll", 0, 2.0, 12.0), ("up", 1, 22.0, 83.0), ("down", -1, 83.0, 129.0)]


def test_a_trip_ends_a_run_and_a_second_run_of_a_name_is_numbered() -> None:
    events = [mark(22, "up"), mark(50, "probe 1x: 912 um", kind="trip"), mark(60, "up")]
    assert [(s.run.name, s.end) for s in find_runs(events, SWEEP)] == [("up", 50.0), ("up 2", float(SWEEP.t[-1]))]


def test_other_notes_end_no_run() -> None:
    events = [mark(22, "up"), mark(30, "3 samples lost", kind="gap"), mark(60, "end")]
    assert [(s.begin, s.end) for s in find_runs(events, SWEEP)] == [(22.0, 60.0)]


def test_without_marks_the_speed_says_what_the_runs_are() -> None:
    spans = find_runs([], SWEEP)
    names = [span.run.name for span in spans]
    assert names == ["slow roll", "up", "dwell 2280 rpm", "down"]
    assert [span.run.direction for span in spans] == [0, 1, 0, -1]
    for span, begin, end in zip(spans, (0, 12, 82, 90), (12, 82, 90, 130), strict=True):
        assert abs(span.begin - begin) < 2.0
        assert abs(span.end - end) < 2.0


@pytest.mark.parametrize(
    ("profile", "names"),
    [
        pytest.param(
            [(0, 300), (10, 300), (40, 2400), (75, 400), (85, 400), (115, 2400), (150, 400)],
            ["slow roll", "up", "down", "dwell 400 rpm", "up 2", "down 2"],
            id="several ups and downs",
        ),
        pytest.param(
            [(0, 800), (10, 800), (14, 1000), (24, 1000), (28, 1400), (38, 1400)],
            ["dwell 800 rpm", "up", "dwell 1000 rpm", "up 2", "dwell 1400 rpm"],
            id="a staircase",
        ),
        pytest.param(
            [(0, 600), (5, 600), (15, 1800), (25, 0), (40, 0), (50, 1800), (60, 0)],
            ["dwell 600 rpm", "up", "down", "up 2", "down 2"],
            id="stop and start",
        ),
        pytest.param(
            [(t, 3000 * np.exp(-t / 20)) for t in np.arange(0, 60, 0.5)], ["down"], id="a coast-down that grows slower"
        ),
        pytest.param([(0, 600), (300, 1200)], ["up"], id="a ramp of 2 rpm/s"),
        pytest.param([(0, 600), (40, 3000), (43, 500), (50, 400)], ["up", "down"], id="a trip"),
    ],
)
def test_hard_cases_are_split_where_the_speed_turns(profile: list[tuple[float, float]], names: list[str]) -> None:
    assert [span.run.name for span in find_runs([], shaft_with(profile))] == names


@pytest.mark.parametrize(("share", "hertz"), [(0.003, 0.5), (0.01, 1.0), (0.01, 0.3)])
def test_a_drive_that_hunts_makes_no_runs_of_its_own(share: float, hertz: float) -> None:
    at = np.arange(0, 140, 0.02)
    rpm = np.interp(at, [0, 10, 70, 80, 140], [300, 300, 3000, 3000, 300])
    hunting = rpm * (1 + share * np.sin(2 * np.pi * hertz * at))
    names = [span.run.name.split()[0] for span in find_runs([], shaft_with([*zip(at, hunting, strict=True)]))]
    assert names == ["slow", "up", "dwell", "down"]


def test_pulses_out_of_time_make_no_runs(rng: np.random.Generator) -> None:
    jittered = fit_shaft_angle(SWEEP.t + 50e-6 * rng.standard_normal(len(SWEEP.t)))
    assert [span.run.name for span in find_runs([], jittered)] == ["slow roll", "up", "dwell 2280 rpm", "down"]


def test_hunting_is_no_run(rng: np.random.Generator) -> None:
    at = np.arange(0, 60, 0.5)
    wandering = [(float(t), float(rpm)) for t, rpm in zip(at, 1200 + 0.6 * rng.standard_normal(len(at)), strict=True)]
    assert [span.run.name for span in find_runs([], shaft_with(wandering))] == ["dwell 1200 rpm"]


def test_a_trial_mass_is_on_in_every_run_the_slow_roll_included() -> None:
    spans = find_runs([], SWEEP, trial=[(0.0, {"disk": 12e-6j})])
    assert [span.run.trial_unbalance for span in spans] == [{"disk": 12e-6j}] * 4


def test_a_run_has_the_trial_mass_that_was_on_when_it_began() -> None:
    events = [mark(2, "slow roll"), mark(12, "up"), mark(40, "end"), mark(60, "up"), mark(80, "end")]
    on = [(50.0, {"disk": 12e-6j}), (70.0, {})]
    spans = find_runs(events, SWEEP, trial=on)
    assert [(s.run.name, s.run.trial_unbalance) for s in spans] == [
        ("slow roll", {}),
        ("up", {}),
        ("up 2", {"disk": 12e-6j}),
    ]


def test_every_way_to_end_a_sweep_ends_its_run() -> None:
    for kind in ("stop", "abort", "emergency", "trip", "pause"):
        (span,) = find_runs([mark(22, "up"), mark(50, "because", kind=kind)], SWEEP)
        assert span.end == 50.0
