"""Words of the PowerFlex 400's registers, against 22C-UM001J, Appendix E."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rotorrig.rig.errors import BadFrame, ConfigError, LimitExceeded
from rotorrig.rig.motor.modbus_frames import decode_speed, decode_status, encode_ramp, encode_speed, fault_text
from rotorrig.rig.motor.profiles.powerflex400 import PROFILE

RPM = math.pi / 30


def test_frequencies_count_hundredths_of_a_hertz() -> None:
    # p. 172: "a decimal 1234 equals 12.34 Hz"; 12.34 Hz of a four-pole motor are 370.2 rpm
    assert decode_speed(1234, profile=PROFILE, rpm_per_hz=30.0) == pytest.approx(370.2 * RPM)
    assert encode_speed(370.2 * RPM, profile=PROFILE, rpm_per_hz=30.0, fastest=400.0) == 1234


@given(st.integers(0, 32_000), st.sampled_from([30.0, 60.0, 58.7]))
def test_a_speed_word_survives_the_way_there_and_back(word: int, rpm_per_hz: float) -> None:
    speed = decode_speed(word, profile=PROFILE, rpm_per_hz=rpm_per_hz)
    assert encode_speed(speed, profile=PROFILE, rpm_per_hz=rpm_per_hz, fastest=1e9) == word


def test_a_ramp_becomes_the_time_to_the_maximum_frequency() -> None:
    # 30 rpm/s to 70 Hz = 4200 rpm take 140 s; the register counts 0.01 s
    assert encode_ramp(30 * RPM, profile=PROFILE, rpm_per_hz=60.0, max_frequency=70.0) == 14_000


@pytest.mark.parametrize(("rpm_per_s", "word"), [(7.0, 60_000), (420_000.0, 1)])
def test_the_slowest_and_fastest_ramp_fit(rpm_per_s: float, word: int) -> None:
    ramp = rpm_per_s * RPM * (1 + 1e-12 if word > 1 else 1 - 1e-12)
    assert encode_ramp(ramp, profile=PROFILE, rpm_per_hz=60.0, max_frequency=70.0) == word


def test_a_ramp_the_drive_does_not_have_is_refused_with_the_ones_it_has() -> None:
    with pytest.raises(ConfigError) as error:
        encode_ramp(2 * RPM, profile=PROFILE, rpm_per_hz=60.0, max_frequency=70.0)
    assert str(error.value) == (
        "ramp: got 2 rpm/s, which takes 2100 s from 0 to the drive's 70 Hz, want 7 to 4.2e+05 rpm/s (600 to 0.01 s)"
    )


@pytest.mark.parametrize("ramp", [0.0, -1.0, math.nan])
def test_a_ramp_that_is_none_is_refused(ramp: float) -> None:
    with pytest.raises(ConfigError, match="want more than 0"):
        encode_ramp(ramp, profile=PROFILE, rpm_per_hz=60.0, max_frequency=70.0)


@pytest.mark.parametrize("speed", [420.0, -1.0, math.nan])
def test_a_speed_beyond_the_limit_is_refused(speed: float) -> None:
    with pytest.raises(LimitExceeded, match="want 0 to 4000 rpm"):
        encode_speed(speed, profile=PROFILE, rpm_per_hz=60.0, fastest=4000 * RPM)


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
    assert str(decode_status(word, profile=PROFILE)) == said


def test_a_status_that_contradicts_itself_is_refused() -> None:
    with pytest.raises(BadFrame, match="got 0xffff, accelerating and decelerating at once"):
        decode_status(0xFFFF, profile=PROFILE)


def test_the_start_word_is_start_forward_at_rate_1() -> None:
    # p. 171: bit 1 start, bits 5,4 = 01 forward, 9,8 = 01 accel rate 1, 11,10 = 01 decel rate 1
    assert PROFILE.start_forward == 2 + 16 + 256 + 1024


def test_faults_are_named() -> None:
    assert fault_text(81, profile=PROFILE) == "communication loss (F81)"
