"""Encoding and decoding of the motor line protocol, version 1 (docs/motor-line.md): pure functions."""

import binascii
import re
from dataclasses import dataclass

from rotorrig.rig.config import RPM
from rotorrig.rig.errors import BadFrame, ConfigError, LimitExceeded
from rotorrig.rig.motor.base import MotorState

PROTOCOL = 1
LONGEST_LINE = 96  # bytes, newline included

_STEP = 0.01 / RPM  # rad/s per count of a speed; rad/s^2 per count of a ramp
_REPLY = re.compile(rb"<([0-9A-F]{2}) ([ -)+-;=?-~]*)\*([0-9A-F]{4})\r?\n")  # printable, without * < >
_IDENTITY = re.compile(r"(\d+) (\d+) (\d+) (encoder|output) (.+)")
_STATE = re.compile(r"(\d+) (\d+) (off|ramping|at-speed|stopping) (.+)")
_SHOWN = 60  # bytes of a bad line quoted in its error


@dataclass(frozen=True, slots=True)
class Reply:
    """A controller's reply: to which request, and either what it says or why it refuses."""

    number: int
    text: str = ""  # after OK
    refusal: str = ""  # code of ERR: "command", "argument", "limit", "fault"; empty: not refused
    reason: str = ""  # the text of ERR


@dataclass(frozen=True, slots=True)
class Identity:
    """A controller's answer to ID: model and limits."""

    max_speed: float  # rad/s
    max_ramp: float  # rad/s^2
    has_encoder: bool
    model: str


def encode_request(number: int, text: str) -> bytes:
    r"""Return the line of request `text` under a sequence number.

    >>> encode_request(2, "SPEED 120000 3000")
    b'>02 SPEED 120000 3000*B1BF\n'
    """
    body = b">%02X %s" % (number, text.encode("ascii"))
    return b"%s*%04X\n" % (body, crc16(body))


def decode_reply(line: bytes) -> Reply:
    r"""Return what a line says, from its `<` to its newline. Raises BadFrame.

    >>> decode_reply(b"<02 OK*858B\n")
    Reply(number=2, text='', refusal='', reason='')
    """
    match = _REPLY.fullmatch(line)
    if not match or len(line) > LONGEST_LINE:
        raise BadFrame(f"reply: got {line[:_SHOWN].hex(' ')}, want '<', number, text, '*' and CRC")
    number, text, crc = match.groups()
    if (want := crc16(line[: match.end(2)])) != int(crc, 16):
        raise BadFrame(f"reply: got {line[:_SHOWN].hex(' ')}, its CRC is {crc.decode()}, want {want:04X}")
    verdict, _, rest = text.decode("ascii").partition(" ")
    if verdict == "OK":
        return Reply(int(number, 16), text=rest)
    code, _, reason = rest.partition(" ")
    if verdict != "ERR" or not code:
        raise BadFrame(f"reply: got '{text.decode('ascii')}', want OK or ERR and a code")
    return Reply(int(number, 16), refusal=code, reason=reason)


def crc16(data: bytes) -> int:
    """Return the CRC-16/CCITT-FALSE of `data`.

    >>> f"{crc16(b'123456789'):04X}"
    '29B1'
    """
    return binascii.crc_hqx(data, 0xFFFF)


def decode_identity(text: str) -> Identity:
    """Return the answer to ID. Raises BadFrame if it is not that of a controller of this protocol."""
    match = _IDENTITY.fullmatch(text)
    if not match:
        raise BadFrame(f"ID: got '{text}', want protocol version, max speed, max ramp, encoder or output, and model")
    version, speed, ramp, source, model = match.groups()
    if int(version) != PROTOCOL:
        raise BadFrame(f"ID: got protocol version {version}, want {PROTOCOL}")
    return Identity(int(speed) * _STEP, int(ramp) * _STEP, source == "encoder", model)


def decode_state(text: str) -> MotorState:
    """Return the answer to STATE; `running` is whether the output is on. Raises BadFrame."""
    match = _STATE.fullmatch(text)
    if not match:
        raise BadFrame(f"STATE: got '{text}', want speed, setpoint, phase and fault")
    speed, setpoint, phase, fault = match.groups()
    return MotorState(
        speed=int(speed) * _STEP,
        setpoint=int(setpoint) * _STEP,
        running=phase != "off",
        at_setpoint=phase == "at-speed",
        fault="" if fault == "-" else fault,
    )


def is_stopped(text: str) -> bool:
    """Return whether the answer to STATE is that of a controller at rest, coasting or ramping down to rest."""
    return is_off(text) or text.split(" ")[2:3] == ["stopping"]


def is_off(text: str) -> bool:
    """Return whether the answer to STATE is that of a controller whose output is off."""
    return text.split(" ")[2:3] == ["off"]


def encode_speed(speed: float, *, fastest: float) -> int:
    """Return the number nearest to `speed` [rad/s]. Raises LimitExceeded above `fastest` [rad/s] or below 0."""
    if not 0 <= speed <= fastest:
        raise LimitExceeded(
            f"speed: asked for {speed * RPM:.0f} rpm, want 0 to {fastest * RPM:.0f} rpm, "
            "the least of motor.max_speed in the config and the controller's maximum"
        )
    return round(speed / _STEP)


def encode_ramp(ramp: float, *, steepest: float) -> int:
    """Return the number nearest to `ramp` [rad/s^2]. Raises ConfigError if the controller cannot be set to it."""
    if not 0.5 * _STEP < ramp <= steepest * (1 + 1e-9):
        raise ConfigError(
            f"ramp: got {ramp * RPM:.4g} rpm/s, want 0.01 to {steepest * RPM:.4g} rpm/s, the controller's maximum"
        )
    return round(ramp / _STEP)
