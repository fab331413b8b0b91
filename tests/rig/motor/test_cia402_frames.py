"""Words of CiA 402 as its command coding and statusword tables print them (Toshiba E6581911, pages 30 to 32)."""

import pytest

from rotorrig.rig.config.units import RPM
from rotorrig.rig.errors import BadFrame, ConfigError, LimitExceeded
from rotorrig.rig.motor import cia402_frames as cia402
from rotorrig.rig.motor.cia402_frames import Item, State

UNIT = 1 / RPM  # rad/s per rpm


@pytest.mark.parametrize(
    ("pattern", "state"),
    [
        ("xxxx xxxx x0xx 0000", State.NOT_READY_TO_SWITCH_ON),
        ("xxxx xxxx x1xx 0000", State.SWITCH_ON_DISABLED),
        ("xxxx xxxx x01x 0001", State.READY_TO_SWITCH_ON),
        ("xxxx xxxx x01x 0011", State.SWITCHED_ON),
        ("xxxx xxxx x01x 0111", State.OPERATION_ENABLED),
        ("xxxx xxxx x00x 0111", State.QUICK_STOP_ACTIVE),
        ("xxxx xxxx x0xx 1111", State.FAULT_REACTION_ACTIVE),
        ("xxxx xxxx x0xx 1000", State.FAULT),
    ],
)
def test_states_are_read_whatever_the_other_bits_are(pattern: str, state: State) -> None:
    for filler in "01":
        word = int(pattern.replace(" ", "").replace("x", filler), 2)
        assert cia402.decode_state(word) is state


def test_a_word_of_no_state_is_bad() -> None:
    with pytest.raises(BadFrame, match="statusword: got 0005h"):
        cia402.decode_state(0x0005)


@pytest.mark.parametrize(
    ("word", "pattern"),
    [
        (cia402.SHUTDOWN, "0xxx x110"),
        (cia402.SWITCH_ON, "0xxx 0111"),
        (cia402.ENABLE_OPERATION, "0xxx 1111"),
        (cia402.DISABLE_VOLTAGE, "0xxx xx0x"),
        (cia402.QUICK_STOP, "0xxx x01x"),
        (cia402.FAULT_RESET, "1xxx xxxx"),
    ],
)
def test_commands_are_those_of_the_command_coding(word: int, pattern: str) -> None:
    bits = f"{word & 0xFF:08b}"
    assert all(want in ("x", bit) for want, bit in zip(pattern.replace(" ", ""), bits, strict=True))
    assert word >> 8 == 0


def test_the_ramp_generator_follows_the_target_once_enabled() -> None:
    assert cia402.ENABLE_OPERATION >> 4 & 0b111 == 0b111  # velocity mode: bits 4, 5, 6


def test_speeds_are_whole_units_within_the_limits() -> None:
    limits = {"unit": UNIT, "slowest": 60 / RPM, "fastest": 3600 / RPM}
    assert cia402.encode_speed(1200.4 / RPM, **limits) == 1200
    assert cia402.encode_speed(0.0, **limits) == 0
    for rpm in (3601, 59, -1):
        with pytest.raises(LimitExceeded, match=f"asked for {rpm} rpm, want 60 to 3600 rpm"):
            cia402.encode_speed(rpm / RPM, **limits)


@pytest.mark.parametrize(
    ("rpm_per_s", "coded"),
    [(30.0, (3000, 100)), (0.5, (5000, 10000)), (1000.0, (1000, 1)), (999.0, (9990, 10)), (0.1, (1000, 10000))],
)
def test_ramps_are_a_quotient_with_four_digits_or_more(rpm_per_s: float, coded: tuple[int, int]) -> None:
    assert cia402.encode_ramp(rpm_per_s / RPM, unit=UNIT) == coded


@pytest.mark.parametrize("rpm_per_s", [0.0, -1.0, 0.09, 32768.0, 5e9, float("nan")])
def test_a_ramp_no_quotient_gives_is_refused(rpm_per_s: float) -> None:
    with pytest.raises(ConfigError, match=r"ramp: got .* want 0\.1 to 3\.277e\+04 rpm/s"):
        cia402.encode_ramp(rpm_per_s / RPM, unit=UNIT)


@pytest.mark.parametrize(
    ("size", "value", "data"),
    [(1, 2, "02"), (2, -300, "d4 fe"), (3, 0x123456, "56 34 12"), (4, 1 << 30, "00 00 00 40")],
)
def test_objects_are_little_endian_and_have_their_sign(size: int, value: int, data: str) -> None:
    item = Item(0x6042, 0, size, "", signed=True)
    assert item.encode(value) == bytes.fromhex(data)
    assert item.decode(bytes.fromhex(data)) == value
    assert item.decode(bytes.fromhex(data) + b"\xff") == value  # a device may send more than it has


def test_objects_of_another_size_are_refused() -> None:
    with pytest.raises(OverflowError):
        cia402.TARGET.encode(1 << 15)
    with pytest.raises(BadFrame, match=r"vl target velocity \(6042h:00\): got 1 bytes, want 2"):
        cia402.TARGET.decode(b"\xd4")


def test_errors_are_named_or_classed() -> None:
    assert cia402.describe_error(0x8130) == "heartbeat or life guarding lost (8130h)"
    assert cia402.describe_error(0x2222) == "current (2222h)"
    assert cia402.describe_error(0xFF01) == "device specific (FF01h)"
    assert cia402.describe_error(0xA000) == "unknown error (A000h)"
