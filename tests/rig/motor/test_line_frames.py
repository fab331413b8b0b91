"""The line protocol's bytes: the worked examples of docs/motor-line.md."""

import re
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rotorrig.rig.config.units import RPM
from rotorrig.rig.errors import BadFrame, ConfigError, LimitExceeded
from rotorrig.rig.motor import line_frames
from rotorrig.rig.motor.line_frames import Reply

SPEC = (Path(__file__).parents[3] / "docs" / "motor-line.md").read_text(encoding="utf-8")
EXAMPLE = SPEC.partition("## Worked example")[2].split("```")[1]
REQUESTS = re.findall(r"^>([0-9A-F]{2}) ([^*\n]*)(\*[0-9A-F]{4})", EXAMPLE, flags=re.MULTILINE)
REPLIES = re.findall(r"^<([0-9A-F]{2}) (OK|ERR) ?([^*\n]*)(\*[0-9A-F]{4})", EXAMPLE, flags=re.MULTILINE)


@pytest.mark.parametrize(("number", "text", "crc"), REQUESTS)
def test_requests_are_the_specs_byte_for_byte(number: str, text: str, crc: str) -> None:
    assert line_frames.encode_request(int(number, 16), text) == f">{number} {text}{crc}\n".encode()


@pytest.mark.parametrize(("number", "verdict", "text", "crc"), REPLIES)
def test_replies_of_the_spec_are_understood(number: str, verdict: str, text: str, crc: str) -> None:
    line = f"<{number} {verdict}{' ' * bool(text)}{text}{crc}"
    reply = line_frames.decode_reply(line.encode() + b"\n")
    assert reply == line_frames.decode_reply(line.encode() + b"\r\n")
    assert reply.number == int(number, 16)
    assert (reply.text if verdict == "OK" else f"{reply.refusal} {reply.reason}") == text


def test_the_example_has_all_of_them() -> None:
    assert (len(REQUESTS), len(REPLIES)) == (10, 10)


@given(st.binary(max_size=120))
def test_other_bytes_are_bad_frames_and_nothing_else(noise: bytes) -> None:
    with pytest.raises(BadFrame):
        line_frames.decode_reply(noise)


@given(st.integers(0, 11), st.integers(1, 255))
def test_a_changed_byte_is_found(at: int, change: int) -> None:
    line = bytearray(b"<02 OK*858B\n")
    line[at] ^= change
    with pytest.raises(BadFrame):
        line_frames.decode_reply(bytes(line))


def test_a_line_with_a_good_crc_that_says_nothing_known_is_a_bad_frame() -> None:
    body = b"<02 MAYBE"
    with pytest.raises(BadFrame, match="want OK or ERR"):
        line_frames.decode_reply(b"%s*%04X\n" % (body, line_frames.crc16(body)))


def test_an_identity_is_read_in_si() -> None:
    known = line_frames.decode_identity("1 420000 6000 encoder RK4 bench controller, rev B")
    assert known.max_speed * RPM == pytest.approx(4200)
    assert known.max_ramp * RPM == pytest.approx(60)
    assert known.has_encoder
    assert known.model == "RK4 bench controller, rev B"


@pytest.mark.parametrize("text", ["", "1 420000 6000 RK4", "2 420000 6000 output RK4", "1 -4 6000 output RK4"])
def test_another_identity_is_refused(text: str) -> None:
    with pytest.raises(BadFrame, match="ID: got"):
        line_frames.decode_identity(text)


@pytest.mark.parametrize(
    ("text", "rpm", "setpoint", "running", "at_setpoint", "fault"),
    [
        ("45012 120000 ramping -", 450.12, 1200.0, True, False, ""),
        ("119996 120000 at-speed -", 1199.96, 1200.0, True, True, ""),
        ("4500 0 stopping -", 45.0, 0.0, True, False, ""),
        ("0 0 off over-temperature of the bridge", 0.0, 0.0, False, False, "over-temperature of the bridge"),
    ],
)
def test_states_are_read_in_si(
    text: str, rpm: float, setpoint: float, running: bool, at_setpoint: bool, fault: str
) -> None:
    state = line_frames.decode_state(text)
    assert (state.speed * RPM, state.setpoint * RPM) == (pytest.approx(rpm), pytest.approx(setpoint))
    assert (state.running, state.at_setpoint, state.fault) == (running, at_setpoint, fault)


def test_another_state_is_refused() -> None:
    with pytest.raises(BadFrame, match="STATE: got '1 2 flying -'"):
        line_frames.decode_state("1 2 flying -")


def test_speeds_and_ramps_are_hundredths_of_rpm_within_the_limits() -> None:
    assert line_frames.encode_speed(1200 / RPM, fastest=1200 / RPM) == 120000
    assert line_frames.encode_ramp(30 / RPM, steepest=100 / RPM) == 3000
    assert line_frames.encode_ramp(0.01 / RPM, steepest=100 / RPM) == 1
    with pytest.raises(LimitExceeded, match="asked for 1201 rpm, want 0 to 1200 rpm"):
        line_frames.encode_speed(1201 / RPM, fastest=1200 / RPM)
    with pytest.raises(LimitExceeded, match="asked for -1 rpm"):
        line_frames.encode_speed(-1 / RPM, fastest=1200 / RPM)
    for ramp in (0.0, -30.0, 0.004, 101.0, float("nan")):
        with pytest.raises(ConfigError, match=r"want 0.01 to 100 rpm/s"):
            line_frames.encode_ramp(ramp / RPM, steepest=100 / RPM)


def test_a_refusal_has_its_code_apart_from_its_reason() -> None:
    line = b"<06 ERR limit speed 500000, at most 420000*07E3\n"
    assert line_frames.decode_reply(line) == Reply(6, refusal="limit", reason="speed 500000, at most 420000")
