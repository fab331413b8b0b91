"""Which measure follows when the rotor does not obey, and when."""

import math
from itertools import pairwise

import pytest

from rotorrig.rig.control import Ladder, Measure
from rotorrig.rig.motor import Stop

STEP = 0.02  # s, of a block
QUICK, COAST, UNSEEN = 3.0, 10.0, 5.0  # s that each is given; a ramp: 3 s and twice what it needs for a tenth


def climb(ladder: Ladder, *, seconds: float, speed: float | None) -> list[tuple[float, Measure]]:
    """Give it so much time at a speed; return the measures that came, and when [s]."""
    taken = []
    for i in range(1, round(seconds / STEP) + 1):
        if measure := ladder.advance(STEP, speed):
            taken.append((i * STEP, measure))
    return taken


def make_ladder(*, watchdog: float | None = None, power_cut: bool = False) -> Ladder:
    ladder = Ladder(ramp=10.0, watchdog=watchdog, power_cut=power_cut)
    ladder.begin(Measure.RAMP, 100.0)
    return ladder


def test_measures_follow_from_gentle_to_harsh_and_then_begin_anew_at_the_quick_stop() -> None:
    ladder = make_ladder(watchdog=2.0, power_cut=True)
    taken = climb(ladder, seconds=40.0, speed=100.0)
    assert [measure for _, measure in taken] == [
        Measure.EMERGENCY,
        Measure.COAST,
        Measure.SILENCE,
        Measure.POWER_CUT,
        Measure.EMERGENCY,
        Measure.COAST,
    ]
    times = [0.0, *(time for time, _ in taken)]
    spans = [after - before for before, after in pairwise(times)]
    ramp = QUICK + 2 * 10.0 / 10.0  # a tenth of 100 rad/s at 10 rad/s^2
    silence = 2.0 + 1.0 + QUICK  # the watchdog's time, its margin, and the time for it to show
    assert spans == pytest.approx([ramp, QUICK, COAST, silence, COAST, QUICK], abs=2 * STEP)


@pytest.mark.parametrize(
    ("watchdog", "power_cut", "last"),
    [
        (None, False, [Measure.COAST]),
        (2.0, False, [Measure.COAST, Measure.SILENCE]),
        (None, True, [Measure.COAST, Measure.POWER_CUT]),
    ],
)
def test_silence_needs_a_watchdog_and_a_power_cut_its_wiring(
    watchdog: float | None, power_cut: bool, last: list[Measure]
) -> None:
    ladder = make_ladder(watchdog=watchdog, power_cut=power_cut)
    measures = [measure for _, measure in climb(ladder, seconds=40.0, speed=100.0)]
    again = measures.index(Measure.EMERGENCY, 1)
    assert measures[1:again] == last


def test_a_drive_whose_speed_hunts_by_little_has_not_obeyed() -> None:
    """1.2 rpm, which a drive that ignores its stop may show, at any speed."""
    hunting = 1.2 * math.pi / 30
    for speed in (3.5, 30.0, 100.0):
        ladder = make_ladder()
        ladder.begin(Measure.EMERGENCY, speed)
        measures = [ladder.advance(STEP, speed - hunting * math.sin(i)) for i in range(200)]
        assert Measure.COAST in measures


def test_a_rotor_that_slows_down_is_left_to_the_present_measure_until_it_stops_slowing() -> None:
    ladder = make_ladder()
    ladder.begin(Measure.EMERGENCY, 100.0)
    speed = 100.0
    for _ in range(round(18.0 / STEP)):
        speed -= 5.0 * STEP
        assert ladder.advance(STEP, speed) is None
    ((when, measure),) = climb(ladder, seconds=QUICK + 1.0, speed=speed)
    assert measure is Measure.COAST
    assert QUICK - 1.0 < when <= QUICK + 2 * STEP


def test_a_rotor_that_slows_down_slower_than_by_friction_has_not_obeyed() -> None:
    ladder = make_ladder()
    ladder.begin(Measure.EMERGENCY, 100.0)
    assert Measure.COAST in [ladder.advance(STEP, 100.0 - 2.0 * i * STEP) for i in range(round(4.0 / STEP))]


def test_unseen_the_ladder_is_climbed_by_time_alone() -> None:
    ladder = make_ladder(power_cut=True)
    ladder.begin(Measure.EMERGENCY, None)
    taken = climb(ladder, seconds=3 * UNSEEN + 1.0, speed=None)
    assert [measure for _, measure in taken] == [Measure.COAST, Measure.POWER_CUT, Measure.EMERGENCY]
    assert [time for time, _ in taken] == pytest.approx([UNSEEN, 2 * UNSEEN, 3 * UNSEEN], abs=4 * STEP)


def test_a_speed_that_is_seen_again_gives_the_present_measure_its_time() -> None:
    ladder = make_ladder()
    ladder.begin(Measure.EMERGENCY, None)
    assert climb(ladder, seconds=4.0, speed=None) == []
    ((when, measure),) = climb(ladder, seconds=QUICK + 1.0, speed=100.0)
    assert measure is Measure.COAST
    assert when == pytest.approx(QUICK, abs=3 * STEP)


def test_only_three_measures_are_stops_the_drive_is_sent() -> None:
    assert [measure.stop for measure in Measure] == [Stop.RAMP, Stop.EMERGENCY, Stop.COAST, None, None]


def test_a_rotor_seen_again_at_speed_is_judged_by_its_fall_from_there() -> None:
    ladder = make_ladder()
    ladder.begin(Measure.EMERGENCY, 3.0)  # by the wait for a pulse of a keyphasor that was silent
    assert climb(ladder, seconds=1.0, speed=25.0) == []
    assert [ladder.advance(STEP, 25.0 - 8.0 * i * STEP) for i in range(150)] == [None] * 150


def test_a_rotor_that_goes_up_and_down_is_not_slowing_down() -> None:
    ladder = make_ladder()
    ladder.begin(Measure.EMERGENCY, 100.0)
    swings = [100.0 + 15.0 * math.sin(2 * math.pi * i * STEP) for i in range(round(8 / STEP))]
    assert Measure.COAST in [ladder.advance(STEP, speed) for speed in swings]
