"""Samples that are lost, or come late, are watched: one frame is no reason to stop, many are."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.errors import LimitExceeded
from rotorrig.rig.interlock import Interlock
from rotorrig.rig.interlock.sample_loss import LateSamples, SampleLoss
from rotorrig.rig.motor.base import MotorState
from rotorrig.rig.probes.base import Block, DaqInfo
from tests.rig.signals import RATE, block, pulse_volts

FRAME = 200  # samples, 20 ms


def frames(seconds: float, *, keyphasor: float = -10.0) -> Iterator[Block]:
    """Yield blocks of 20 ms of a rotor at rest."""
    still = block(np.full(FRAME, keyphasor))
    for first in range(0, round(seconds * RATE), FRAME):
        yield replace(still, first_sample=first, t_ns=round(first * 1e9 / RATE))


def test_one_frame_lost_every_few_seconds_stops_nothing(info: DaqInfo) -> None:
    loss = SampleLoss(info)
    for i, one in enumerate(frames(300.0)):
        if i % 100 != 50:  # one in two seconds: 1 %
            loss.check(one)


def test_five_percent_of_the_frames_lost_are_noticed_within_seconds(info: DaqInfo) -> None:
    loss, rng = SampleLoss(info), np.random.default_rng(3)
    with pytest.raises(LimitExceeded, match=r"DAQ: 2\d\d ms of samples are missing in 1\d gaps within 10 s") as error:
        for one in frames(38.0):
            last = one.first_sample / RATE
            if rng.random() > 0.05:
                loss.check(one)
    assert last < 8.0
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(("lost", "trips"), [(0.48, False), (0.52, True)])
def test_half_a_second_in_one_piece_is_too_much(info: DaqInfo, lost: float, trips: bool) -> None:
    loss = SampleLoss(info)
    loss.check(next(frames(1.0)))
    later = replace(next(frames(1.0)), first_sample=FRAME + round(lost * RATE))
    if trips:
        with pytest.raises(LimitExceeded, match=r"DAQ: 0\.52 s of samples are missing in one piece"):
            loss.check(later)
    else:
        loss.check(later)


def test_a_gap_while_the_rotor_is_worked_on_is_forgotten(rk4: RigConfig, info: DaqInfo) -> None:
    interlock = Interlock(rk4, info)
    first, *others = frames(60.0)
    interlock.check(first)
    interlock.follow(others[-2])
    interlock.check(others[-1])


def test_a_keyphasor_lost_among_gaps_is_found_by_the_sample_clock(rk4: RigConfig, info: DaqInfo) -> None:
    interlock = Interlock(rk4, info)
    turning = MotorState(speed=157.0, setpoint=157.0, running=True, at_setpoint=True)
    interlock.check(block(pulse_volts(25 * np.arange(20_000) / RATE)))
    interlock.check_motor(turning)
    with pytest.raises(LimitExceeded, match=r"keyphasor: no pulse for 2\.\d s while the drive reports 1499 rpm"):
        for i, one in enumerate(frames(3.0)):
            if i % 75 != 74:  # a frame lost every 1.5 s, each before the keyphasor was silent for 2 s
                interlock.follow(replace(one, first_sample=one.first_sample + 20_000))
                interlock.check_motor(turning)


def late_by(info: DaqInfo, lags: list[float]) -> None:
    """Give one frame after the other to the watch, each `lag` seconds after the last of its samples was taken."""
    watch = LateSamples(info)
    for one, lag in zip(frames(len(lags) * FRAME / RATE), lags, strict=True):
        watch.check(one, 1000.0 + (one.first_sample + FRAME) / RATE + lag)


def test_samples_that_fall_behind_are_noticed_before_they_are_a_second_late(info: DaqInfo) -> None:
    with pytest.raises(LimitExceeded, match=r"DAQ: its samples arrive 0\.\d s late, want at most 0\.5 s"):
        late_by(info, [0.02 + 0.5 * FRAME / RATE * i for i in range(200)])  # half a second late after one second


def test_samples_late_by_a_steady_amount_are_as_prompt_as_this_daq_is(info: DaqInfo) -> None:
    late_by(info, [0.3] * 200)


def test_a_backlog_that_is_read_quickly_is_no_lateness(info: DaqInfo) -> None:
    paused = [2.0 - 0.019 * i for i in range(100)]  # read at 1 ms a frame after a pause of two seconds
    late_by(info, [0.02] * 50 + paused + [0.02] * 50)


def test_a_sample_clock_a_thousandth_slow_is_not_late_after_an_hour(info: DaqInfo) -> None:
    late_by(info, [1e-3 * i * FRAME / RATE for i in range(180_000)])


def test_a_simulated_clock_may_take_its_time(info: DaqInfo) -> None:
    late_by(replace(info, simulated=True), [0.05 * i for i in range(200)])
