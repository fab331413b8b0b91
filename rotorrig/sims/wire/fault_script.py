"""Scripted faults of a simulated bench: what goes wrong, where, from when and for how long.

A script is a JSON list of tables, checked as a config is; docs/simulated-rig.md lists the kinds:

    [{"kind": "corrupt", "on": "motor", "at": "3 s", "count": 1},
     {"kind": "disconnect", "on": "daq", "above": "900 rpm", "lasts": "2 s"}]

or, to draw other messages and bits, `{"seed": 7, "faults": [...]}`. `at` is simulated time since the script was given.
A fault of a link is about patience, which runs in wall time, and so do its `lasts` and `by`; the others' is simulated.
"""

import json
from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import Discriminator, Field, model_validator

from rotorrig.rig import ConfigError
from rotorrig.rig.config import Part, Speed, Time, reads, validate_table

Device = Literal["motor", "daq"]
Direction = Literal["both", "to-device", "from-device"]


class _Fault(Part):
    """Begin and end of a fault."""

    at: Annotated[float, reads("time"), Field(ge=0)] = 0.0  # s of simulated time since the script was given
    above: Speed | None = None  # once the shaft has first been faster than this, then or later
    lasts: Time | None = None  # None: to the end


class _OfMessages(_Fault):
    """Something that befalls messages: what a link carries in one go, so a whole request, reply or frame."""

    on: Device
    direction: Direction = "both"
    share: float = Field(1.0, gt=0, le=1)  # of the messages, drawn at random
    count: int | None = Field(None, ge=1)  # ends after so many


class Drop(_OfMessages):
    """Messages, or some bytes of them, are lost."""

    kind: Literal["drop"]
    bytes: int | None = Field(None, ge=1)  # at random places; None: all


class Corrupt(_OfMessages):
    """Bits flip."""

    kind: Literal["corrupt"]
    bits: int = Field(1, ge=1)  # of a message, at random places


class Delay(_OfMessages):
    """Messages arrive late, in their order."""

    kind: Literal["delay"]
    by: Time


class Duplicate(_OfMessages):
    """Messages arrive twice."""

    kind: Literal["duplicate"]


class Silent(_Fault):
    """The device hangs: its port is there, but it hears and says nothing."""

    kind: Literal["silent"]
    on: Device


class Disconnect(_Fault):
    """The device is unplugged: its port is gone; plugged in again it has the same name."""

    kind: Literal["disconnect"]
    on: Device


class WrongDevice(_Fault):
    """Another device answers at the port: a modem on a serial line, a web server at a TCP port.

    With an `address` a Modbus drive answers as another node instead, or another unit.
    """

    kind: Literal["wrong-device"]
    on: Device
    address: int | None = Field(None, ge=0, le=255)

    @model_validator(mode="after")
    def _has_an_address(self) -> Self:
        if self.address is not None and self.on == "daq":
            raise ValueError("address: a DAQ has none, want it on 'motor' alone")
        return self


class StuckSpeed(_Fault):
    """The shaft keeps the speed it has while it is powered; the drive believes it follows."""

    kind: Literal["stuck-speed"]
    on: Literal["motor"] = "motor"


class DriveFault(_Fault):
    """The drive trips and remembers why."""

    kind: Literal["drive-fault"]
    on: Literal["motor"] = "motor"
    code: int = Field(4, ge=1, le=255)  # in the drive's own numbering


class DaqOverrun(_Fault):
    """The DAQ loses samples, and knows."""

    kind: Literal["daq-overrun"]
    on: Literal["daq"] = "daq"


class KeyphasorLost(_Fault):
    """The keyphasor's cable is off: its channel reads 0 V."""

    kind: Literal["keyphasor-lost"]
    on: Literal["daq"] = "daq"


OfMessages = Drop | Corrupt | Delay | Duplicate
OfLink = OfMessages | Silent | Disconnect | WrongDevice
Fault = Annotated[OfLink | StuckSpeed | DriveFault | DaqOverrun | KeyphasorLost, Discriminator("kind")]


class Script(Part):
    """Faults, and the seed that draws which messages and bits they hit; with `calm` those before it end first."""

    calm: bool = False
    seed: int = Field(0, ge=0)
    faults: tuple[Fault, ...] = ()


def read_script(path: Path) -> Script:
    """Read and check a script file. Raises ConfigError naming file, key, what was got and what is wanted."""
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "not UTF-8 text"
        raise ConfigError(f"{path}: cannot be read ({reason}), want a script of faults in JSON") from error
    return parse_script(text, where=str(path))


def parse_script(text: str, *, where: str) -> Script:
    """Check a script's text; `where` names it in errors. Raises ConfigError."""
    try:
        table = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise ConfigError(f"{where}: is no valid JSON: {error}") from error
    if isinstance(table, list):
        table = {"faults": table}
    if not isinstance(table, dict):
        raise ConfigError(f"{where}: got {json.dumps(table)[:40]}, want a list of faults")
    return validate_table(Script, table, where=where, context={"si": True})
