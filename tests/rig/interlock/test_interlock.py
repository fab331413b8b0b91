"""The interlock trips on what harms the rotor, says why in one sentence, and on nothing else."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.config.devices import CriticalBand
from rotorrig.rig.errors import LimitExceeded
from rotorrig.rig.interlock import Interlock
from rotorrig.rig.motor.base import MotorState
from rotorrig.rig.probes.base import Block, DaqInfo
from tests.rig.signals import RATE, block, cut, pulse_volts

RPM = math.pi / 30
T = np.arange(20_000) / RATE
EVERY_20_MS = list(range(200, 20_000, 200))


def vibrating(amplitude: float, rpm: float, *, mean: float = 0.0) -> Block:
    """Return two seconds of 1X vibration of probe 1x at a speed; the keyphasor goes with it."""
    turns = rpm / 60 * T - 0.25
    return block(pulse_volts(turns), mean + amplitude * np.cos(2 * np.pi * turns))


def watch(interlock: Interlock, whole: Block, *, at: list[int] = EVERY_20_MS) -> None:
    for piece in cut(whole, at):
        interlock.check(piece)


def turning(rpm: float, *, running: bool = True, fault: str = "") -> MotorState:
    return MotorState(speed=rpm * RPM, setpoint=rpm * RPM, running=running, at_setpoint=True, fault=fault)


def trip(interlock: Interlock, whole: Block) -> str:
    with pytest.raises(LimitExceeded) as error:
        watch(interlock, whole)
    assert "\n" not in str(error.value)
    return str(error.value)


def test_a_healthy_run_trips_nothing(rk4: RigConfig, info: DaqInfo) -> None:
    interlock = Interlock(rk4, info)
    watch(interlock, vibrating(880e-6, 2231))
    interlock.check_motor(turning(2231))


def test_vibration_names_probe_amplitude_speed_and_limit(rk4: RigConfig, info: DaqInfo) -> None:
    rising = np.clip(2 * T - 2, 0, 0.912) * 1e-3  # 907 um at the first half turn after 1.45 s
    said = trip(Interlock(rk4, info), block(pulse_volts(37.5 * T), rising * np.cos(2 * np.pi * 37.5 * T)))
    amplitude = re.fullmatch(r"probe 1x: (\d+) um at 2250 rpm, limit 900 um", said)
    assert amplitude
    assert float(amplitude[1]) == pytest.approx(907, rel=0.005)  # the running mean's own ripple: 1 / (omega * 1 s)


def test_a_speed_not_yet_known_is_not_invented(rk4: RigConfig, info: DaqInfo) -> None:
    assert trip(Interlock(rk4, info), vibrating(912e-6, 2250)) == "probe 1x: 912 um, limit 900 um"


def test_a_rotor_that_becomes_too_loud_is_stopped_at_once(rk4: RigConfig, info: DaqInfo) -> None:
    interlock = Interlock(rk4, info)
    watch(interlock, vibrating(100e-6, 2250))
    louder = cut(vibrating(912e-6, 2250), [400])[0]  # 40 ms, a turn and a half
    with pytest.raises(LimitExceeded, match=r"^probe 1x: 91. um at 22.. rpm, limit 900 um$"):
        interlock.check(replace(louder, first_sample=20_000))


def test_vibration_counts_from_the_mean_and_not_from_the_gap(rk4: RigConfig, info: DaqInfo) -> None:
    watch(Interlock(rk4, info), vibrating(500e-6, 1200, mean=600e-6))


def test_the_mean_of_a_slow_turn_is_not_its_vibration(rk4: RigConfig, info: DaqInfo) -> None:
    # a 20 ms block sees a twelfth of a 240 rpm turn: its own mean would hide the vibration
    said = trip(Interlock(rk4, info), vibrating(1000e-6, 240))
    assert said.startswith("probe 1x:")


def test_a_mean_that_creeps_is_followed(rk4: RigConfig, info: DaqInfo) -> None:
    creep = np.linspace(-450e-6, 450e-6, len(T))  # thermal, only much faster
    watch(Interlock(rk4, info), block(pulse_volts(20 * T), creep))


def test_two_stray_samples_are_a_spike_and_three_are_not(rk4: RigConfig, info: DaqInfo) -> None:
    spiked = np.zeros(len(T))
    spiked[10_050:10_052] = 1200e-6
    watch(Interlock(rk4, info), block(pulse_volts(20 * T), spiked))
    spiked[10_050:10_053] = 1200e-6
    assert "probe 1x: 12" in trip(Interlock(rk4, info), block(pulse_volts(20 * T), spiked))


def test_every_probe_is_watched(rk4: RigConfig, info: DaqInfo) -> None:
    quiet, loud = np.zeros(len(T)), 1000e-6 * np.sin(2 * np.pi * 20 * T)
    for i, name in enumerate(("1x", "1y", "2x", "2y")):
        probes = [quiet] * 4
        probes[i] = loud
        assert trip(Interlock(rk4, info), block(pulse_volts(20 * T), *probes)).startswith(f"probe {name}: ")


def test_an_inverting_input_is_watched_as_well(rk4: RigConfig, info: DaqInfo) -> None:
    inverted = replace(info, volts_per_count=tuple(-v for v in info.volts_per_count))
    loud = vibrating(1000e-6, 1200)
    turned = Block(counts=-loud.counts, first_sample=0, t_ns=0)
    assert trip(Interlock(rk4, inverted), turned).startswith("probe 1x: ")


def test_a_clipped_probe_cannot_be_watched(rk4: RigConfig, info: DaqInfo) -> None:
    narrow = replace(info, volts_per_count=(12 / 32768,) * 5)  # +-12 V: 254 um below the gap voltage
    whole = block(2 * pulse_volts(20 * T) + 10)  # volts of a +-24 V DAQ, twice what they are here
    whole.counts[:, :4] = -27307  # -10 V
    whole.counts[5000:5002, 2] = -32768
    watch(Interlock(rk4, narrow), whole)
    whole.counts[5002, 2] = -32768
    assert trip(Interlock(rk4, narrow), whole) == (
        "probe 2x: reads -12.0 V at 1200 rpm, the end of the DAQ's range, where its vibration cannot be watched; "
        "check its gap and cable"
    )


def test_overspeed_is_told_by_the_keyphasor(rk4: RigConfig, info: DaqInfo) -> None:
    said = trip(Interlock(rk4, info), vibrating(0, 4080))
    assert said.startswith("overspeed: 40")
    assert said.endswith("rpm by the keyphasor, limit 4000 rpm")


def test_one_stray_pulse_is_no_overspeed(rk4: RigConfig, info: DaqInfo) -> None:
    volts = pulse_volts(60 * T)  # 3600 rpm; twice that for one turn
    volts[10_070:10_075] = -2.0
    watch(Interlock(rk4, info), block(volts))


def test_overspeed_is_told_by_the_drive_too(rk4: RigConfig, info: DaqInfo) -> None:
    with pytest.raises(LimitExceeded, match="overspeed: 4100 rpm by the drive, limit 4000 rpm"):
        Interlock(rk4, info).check_motor(turning(4100))


def test_a_tripped_drive_ends_the_run(rk4: RigConfig, info: DaqInfo) -> None:
    with pytest.raises(LimitExceeded, match=r"drive: has tripped with 'overvoltage \(F5\)' at 1500 rpm"):
        Interlock(rk4, info).check_motor(turning(1500, fault="overvoltage (F5)"))


def test_a_keyphasor_that_falls_silent_under_way_is_lost(rk4: RigConfig, info: DaqInfo) -> None:
    interlock = Interlock(rk4, info)
    watch(interlock, vibrating(0, 1500))
    interlock.check_motor(turning(1500))
    silent = block(np.full(len(T), -10.0), first_sample=20_000)
    watch(interlock, silent)
    interlock.check_motor(turning(1500))  # 1.98 s after the last pulse: not yet
    interlock.check(block(np.full(500, -10.0), first_sample=40_000))
    with pytest.raises(LimitExceeded, match=r"keyphasor: no pulse for 2\.\d s while the drive reports 1500 rpm"):
        interlock.check_motor(turning(1500))


def test_a_rotor_long_at_rest_gets_its_time_to_turn(rk4: RigConfig, info: DaqInfo) -> None:
    interlock = Interlock(rk4, info)
    at_rest = block(np.full(len(T), -10.0))
    for k in range(5):  # ten seconds
        interlock.check(Block(counts=at_rest.counts, first_sample=20_000 * k, t_ns=0))
        interlock.check_motor(turning(0, running=False))
    interlock.check_motor(turning(60))  # five turns take 5 s
    for k in range(5, 7):
        interlock.check(Block(counts=at_rest.counts, first_sample=20_000 * k, t_ns=0))
    interlock.check_motor(turning(60))
    interlock.check(Block(counts=at_rest.counts, first_sample=140_000, t_ns=0))
    with pytest.raises(LimitExceeded, match="keyphasor: no pulse for 6"):
        interlock.check_motor(turning(60))


def test_a_coasting_rotor_needs_no_pulses(rk4: RigConfig, info: DaqInfo) -> None:
    interlock = Interlock(rk4, info)
    interlock.check_motor(turning(1500))
    for k in range(5):
        interlock.check(block(np.full(20_000, -10.0), first_sample=20_000 * k))
    interlock.check_motor(turning(0, running=False))


def without_limits(rig: RigConfig) -> RigConfig:
    return rig.model_copy(update={"limits": None})


def test_without_limits_vibration_is_watched_up_to_the_end_of_the_linear_range(rk4: RigConfig, info: DaqInfo) -> None:
    watch(Interlock(without_limits(rk4), info), vibrating(1000e-6, 2250))  # 8 V from -10 to -2 V are 1016 um
    said = trip(Interlock(without_limits(rk4), info), vibrating(1030e-6, 2250))
    assert said.endswith("limit 1016 um")


def test_without_limits_the_speed_is_watched_up_to_five_percent_above_the_motors(rk4: RigConfig, info: DaqInfo) -> None:
    assert rk4.motor and rk4.motor.max_speed == pytest.approx(4200 * RPM)
    interlock = Interlock(without_limits(rk4), info)
    watch(interlock, vibrating(0, 4400))
    interlock.check_motor(turning(4400))
    with pytest.raises(LimitExceeded, match="overspeed: 4420 rpm by the drive, limit 4410 rpm"):
        interlock.check_motor(turning(4420))
    said = trip(Interlock(without_limits(rk4), info), vibrating(0, 4430))
    assert said.endswith("rpm by the keyphasor, limit 4410 rpm")


def test_without_keyphasor_the_drive_and_the_probes_are_watched(rk4: RigConfig, info: DaqInfo) -> None:
    interlock = Interlock(rk4.model_copy(update={"limits": None, "keyphasor": None}), info)
    watch(interlock, vibrating(1000e-6, 4300))
    interlock.check_motor(turning(4300))
    with pytest.raises(LimitExceeded):
        interlock.check_motor(turning(4300, fault="motor overload (F7)"))
    assert trip(interlock, replace(vibrating(1100e-6, 4300), first_sample=20_000)).startswith("probe 1x: 1")


def test_an_empty_block_is_no_reason_to_trip(rk4: RigConfig, info: DaqInfo) -> None:
    Interlock(rk4, info).check(Block(counts=np.empty((0, 5), np.int32), first_sample=0, t_ns=0))


def limited(rig: RigConfig, **limits: object) -> RigConfig:
    assert rig.limits
    return rig.model_copy(update={"limits": rig.limits.model_copy(update=limits)})


def test_a_probe_may_have_a_limit_of_its_own(rk4: RigConfig, info: DaqInfo) -> None:
    own = limited(rk4, probes={"1y": 200e-6})
    quiet, loud = np.zeros(len(T)), 300e-6 * np.sin(2 * np.pi * 20 * T)
    watch(Interlock(own, info), block(pulse_volts(20 * T), loud))
    assert trip(Interlock(own, info), block(pulse_volts(20 * T), quiet, loud)).endswith("limit 200 um")


BAND = CriticalBand.model_construct(low=2000 * RPM, high=2400 * RPM, vibration=1100e-6, probes={})


def test_inside_a_critical_band_its_own_limit_counts(rk4: RigConfig, info: DaqInfo) -> None:
    banded = limited(rk4, critical_bands=(BAND,))
    inside = Interlock(banded, info)
    watch(inside, vibrating(500e-6, 2231))  # until the speed is known
    louder = replace(vibrating(1000e-6, 2231), first_sample=20_000)
    watch(inside, louder)
    outside = Interlock(banded, info)
    watch(outside, vibrating(500e-6, 2531))
    with pytest.raises(LimitExceeded, match=r"^probe 1x: 100\d um at \d+ rpm, limit 900 um$"):
        watch(outside, replace(vibrating(1000e-6, 2531), first_sample=20_000))


def test_a_band_may_be_stricter_for_one_probe_and_is_named(rk4: RigConfig, info: DaqInfo) -> None:
    strict = limited(rk4, critical_bands=(BAND.model_copy(update={"probes": {"1x": 400e-6}}),))
    interlock = Interlock(strict, info)
    watch(interlock, vibrating(300e-6, 2231))
    with pytest.raises(LimitExceeded, match=r"limit 400 um in the critical band 2000-2400 rpm$"):
        watch(interlock, replace(vibrating(500e-6, 2231), first_sample=20_000))


def test_an_unknown_speed_is_in_no_band(rk4: RigConfig, info: DaqInfo) -> None:
    assert trip(Interlock(limited(rk4, critical_bands=(BAND,)), info), vibrating(1000e-6, 2231)).endswith(
        "limit 900 um"
    )


def test_a_rotor_that_is_being_stopped_is_followed_and_no_longer_judged(rk4: RigConfig, info: DaqInfo) -> None:
    interlock = Interlock(rk4, info)
    for piece in cut(vibrating(1000e-6, 2231), EVERY_20_MS):
        interlock.follow(piece)
    assert interlock.keyphasor
    assert interlock.keyphasor.speed / RPM == pytest.approx(2231, rel=1e-3)
