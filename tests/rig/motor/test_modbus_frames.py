"""Words of the PowerFlex 400's registers, against 22C-UM001J, Appendix E, and the ways other families count."""

import math
from types import ModuleType

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rotorrig.rig.errors import BadFrame, ConfigError, LimitExceeded
from rotorrig.rig.motor.modbus_frames import (
    Scale,
    decode_state,
    describe_fault,
    encode_ramp,
    encode_speed,
    encode_watchdog,
    radians_per_hz,
)
from rotorrig.rig.motor.modbus_profile import Ramps, Watchdog
from rotorrig.rig.motor.profiles import acs355, m_max, powerflex400, vfd_ed
from rotorrig.rig.motor.profiles.powerflex400 import PROFILE

RPM = math.pi / 30
RAMPS = Ramps(accel_time=39, step=0.01, range=(0.01, 600.0))
HUNDREDTHS = Scale(step=0.01)


def state(status: int, *, output: int = 0) -> str:
    return str(decode_state([status, 0, 0, output], profile=PROFILE))


def test_frequencies_count_hundredths_of_a_hertz() -> None:
    # p. 172: "a decimal 1234 equals 12.34 Hz"; 12.34 Hz of a four-pole motor are 370.2 rpm
    assert decode_state([0x010F, 0, 1234, 1234], profile=PROFILE).frequency == pytest.approx(12.34)
    assert encode_speed(370.2 * RPM, scale=HUNDREDTHS, rpm_per_hz=30.0, fastest=400.0) == 1234


def test_a_negative_output_is_a_frequency_all_the_same() -> None:
    # two's complement: the M-Max reports +- 0.01 Hz
    assert decode_state([0x000F, 0, 0, 0x10000 - 1234], profile=PROFILE).frequency == pytest.approx(12.34)


@given(
    st.integers(0, 32_000), st.sampled_from([30.0, 60.0, 58.7]), st.sampled_from([0.01, 0.0065, 0.07]), st.floats(0, 20)
)
def test_a_speed_word_survives_the_way_there_and_back(word: int, rpm_per_hz: float, step: float, low: float) -> None:
    scale = Scale(step=step, low=low)
    speed = scale.hertz(word) * radians_per_hz(rpm_per_hz)
    assert encode_speed(speed * (1 + 1e-15), scale=scale, rpm_per_hz=rpm_per_hz, fastest=1e9) == word


def test_a_reference_that_begins_above_zero_reaches_no_lower() -> None:
    # 0 to 10000 from 20 Hz to 70 Hz, two poles: 45 Hz are half of it, 1200 rpm the slowest
    scale = Scale(step=50 / 10_000, low=20.0)
    assert encode_speed(2700 * RPM, scale=scale, rpm_per_hz=60.0, fastest=4200 * RPM) == 5_000
    with pytest.raises(LimitExceeded, match="asked for 600 rpm, want 1200 to 4200 rpm"):
        encode_speed(600 * RPM, scale=scale, rpm_per_hz=60.0, fastest=4200 * RPM)


def test_a_ramp_becomes_the_time_to_the_maximum_frequency() -> None:
    # 30 rpm/s to 70 Hz = 4200 rpm take 140 s; the register counts 0.01 s
    assert encode_ramp(30 * RPM, ramps=RAMPS, rpm_per_hz=60.0, max_frequency=70.0) == 14_000


@pytest.mark.parametrize(("rpm_per_s", "word"), [(7.0, 60_000), (420_000.0, 1)])
def test_the_slowest_and_fastest_ramp_fit(rpm_per_s: float, word: int) -> None:
    ramp = rpm_per_s * RPM * (1 + 1e-12 if word > 1 else 1 - 1e-12)
    assert encode_ramp(ramp, ramps=RAMPS, rpm_per_hz=60.0, max_frequency=70.0) == word


def test_a_ramp_the_drive_does_not_have_is_refused_with_the_ones_it_has() -> None:
    with pytest.raises(ConfigError) as error:
        encode_ramp(2 * RPM, ramps=RAMPS, rpm_per_hz=60.0, max_frequency=70.0)
    assert str(error.value) == (
        "ramp: got 2 rpm/s, which takes 2100 s from 0 to the drive's 70 Hz, want 7 to 4.2e+05 rpm/s (600 to 0.01 s)"
    )


@pytest.mark.parametrize("ramp", [0.0, -1.0, math.nan])
def test_a_ramp_that_is_none_is_refused(ramp: float) -> None:
    with pytest.raises(ConfigError, match="want more than 0"):
        encode_ramp(ramp, ramps=RAMPS, rpm_per_hz=60.0, max_frequency=70.0)


@pytest.mark.parametrize("speed", [420.0, -1.0, math.nan])
def test_a_speed_beyond_the_limit_is_refused(speed: float) -> None:
    with pytest.raises(LimitExceeded, match="want 0 to 4000 rpm"):
        encode_speed(speed, scale=HUNDREDTHS, rpm_per_hz=60.0, fastest=4000 * RPM)


@pytest.mark.parametrize(
    ("patience", "step", "longest", "word"),
    [(2.0, 0.1, 60.0, 20), (2.01, 0.1, 60.0, 21), (1.5, 1.0, 255.0, 2), (60.0, 0.1, 60.0, 600), (90.0, 0.1, 60.0, 600)],
)
def test_a_watchdog_is_never_shorter_than_asked_unless_the_drive_knows_no_longer(
    patience: float, step: float, longest: float, word: int
) -> None:
    assert encode_watchdog(patience, watchdog=Watchdog(register=0, step=step, range=(step, longest))) == word


@pytest.mark.parametrize(
    ("word", "said"),
    [
        (0x000D, "at rest"),  # ready, commanded and rotating forward
        (0x001F, "running, accelerating"),
        (0x010F, "running, at reference"),
        (0x002F, "running, decelerating"),
        (0x008C, "faulted"),
    ],
)
def test_status_bits_are_those_of_page_172(word: int, said: str) -> None:
    assert state(word) == said


def test_a_status_that_contradicts_itself_is_refused() -> None:
    with pytest.raises(BadFrame, match="got 0xffff, accelerating and decelerating at once"):
        state(0xFFFF)


@pytest.mark.parametrize(
    ("family", "status", "output", "reverse"),
    [
        (powerflex400, 0b1011, 1000, False),  # p. 172: bit 3 is the actual direction, 1 forward
        (powerflex400, 0b0011, 1000, True),
        (powerflex400, 0b0001, 0, False),  # at rest it has none
        (m_max, 0b0010, 1000, False),  # p. 139: bit 2, 1 anticlockwise; p. 138: motor frequency +/- Hz
        (m_max, 0b0110, 1000, True),
        (m_max, 0b0110, 0, False),
        (m_max, 0b0010, -1000 & 0xFFFF, True),
        (acs355, 0b0100, 100, False),
        (acs355, 0b0100, -100 & 0xFFFF, True),
        (vfd_ed, 0b0_0011, 1000, False),  # p. 441: bits 4 and 3, 00 forward, 01 and 10 changing over, 11 reverse
        (vfd_ed, 0b1_1011, 1000, True),
        (vfd_ed, 0b0_1011, 1000, True),
        (vfd_ed, 0b1_1011, 0, False),
        (vfd_ed, 0b0_0011, -1000 & 0xFFFF, True),
    ],
)
def test_a_drive_says_that_it_turns_backward(family: ModuleType, status: int, output: int, reverse: bool) -> None:
    profile = family.PROFILE
    words = dict.fromkeys(profile.state_registers, 0) | {profile.output_frequency: output, profile.status: status}
    reading = decode_state(list(words.values()), profile=profile)
    assert (reading.reverse, reading.frequency > 0) == (reverse, output != 0)


@pytest.mark.parametrize(("speed", "reverse"), [(600, False), (-600 & 0xFFFF, True), (0, False)])
def test_an_acs355_says_that_it_turns_backward_by_the_sign_of_its_speed(speed: int, reverse: bool) -> None:
    # 0101 has a sign, negative is reverse; 0103, the output frequency, has none
    reading = decode_state([0x47F, 3333, 0, 0b0100, 100, speed], profile=acs355.PROFILE)
    assert (reading.reverse, reading.frequency) == (reverse, 10.0)


@pytest.mark.parametrize(
    ("status", "running", "decelerating"),
    [(0b00, False, False), (0b01, False, True), (0b10, True, False), (0b11, True, False)],
)
def test_a_vfd_ed_says_by_two_bits_whether_it_runs(status: int, running: bool, decelerating: bool) -> None:
    # p. 440: 00 fully stopped, 01 stopping, 10 standby (RUN is lit, STOP flashes), 11 running
    reading = decode_state([0, 0, 2000, 1000, status | 1 << 8 | 1 << 10], profile=vfd_ed.PROFILE)
    assert (reading.running, reading.decelerating, reading.at_reference) == (running, decelerating, False)


@pytest.mark.parametrize(("word", "faulted"), [(0x0007, True), (0x0700, False), (0, False)])
def test_a_warning_of_a_vfd_ed_is_no_fault(word: int, faulted: bool) -> None:
    # p. 440: 2100H bits 7 to 0 fault code, 15 to 8 warning code
    assert decode_state([word, 0, 2000, 2000, 0b11], profile=vfd_ed.PROFILE).faulted is faulted


def test_the_start_word_is_start_forward_at_rate_1() -> None:
    # p. 171: bit 1 start, bits 5,4 = 01 forward, 9,8 = 01 accel rate 1, 11,10 = 01 decel rate 1
    assert PROFILE.start == (2 + 16 + 256 + 1024,)


def test_faults_are_named() -> None:
    assert describe_fault(81, profile=PROFILE) == "communication loss (F81)"
    assert describe_fault(99, profile=PROFILE) == "fault F99, see its manual"
