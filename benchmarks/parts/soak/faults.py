"""The faults of the campaign: what is done to the rig, when, and what the program is to do about it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

Script = Mapping[str, Any]  # a fault of rotorrig/sims/wire/fault_script.py without its moment


class Ends(StrEnum):
    """How a sweep is to end."""

    FINISHED = "goes on"
    STOPPED = "stops the rotor"
    LINK_LOST = "says that the link is lost; the drive stops by itself"
    INTERRUPTED = "stops the rotor, status 130"
    KILLED = "is dead; the drive stops by itself"
    DISK_FULL = "stops the rotor, closes what it has"


@dataclass(frozen=True, slots=True, kw_only=True)
class Fault:
    """One fault: a `script` for those of the bench, `signals` or a full disk for what befalls the program itself."""

    name: str
    where: str  # "motor link", "drive", "DAQ", "program"
    words: str  # for the page: what is done
    script: Script | None = None
    signals: tuple[str, ...] = ()  # to the program; the next one follows when the rotor is at rest, or soon
    disk_full: bool = False
    ends: Ends
    recorded: tuple[str, ...] = ()  # kinds of the event that is to say so in the recording; (): those of `ends`
    says: str = ""  # a pattern: has to be in what the program says or records
    never: str = ""  # a pattern: must not be
    window: tuple[float, float] = (1.5, 11.0)  # s after the start of the stream, of the rig's time
    stops_within: float = 20.0  # s from the fault to rest, of the rig's time
    drives: tuple[str, ...] = field(default=())  # those it is for; (): all


_LINK = r"(?i)link|answer|lost|port|no reply|unplugged|gone"
_TRIP = r"(?i)trip|fault|limit"
_GAP = r"(?i)missing|gap|lost samples"
_SOUND = r"(?i)\btrip|emergency|abort|MAY STILL"  # what a sweep that went on must not say

MOTOR_LINK = (
    Fault(
        name="one message lost",
        where="motor link",
        words="a request or a reply does not arrive",
        script={"kind": "drop", "on": "motor", "count": 1},
        ends=Ends.FINISHED,
        never=_SOUND,
    ),
    Fault(
        name="a byte lost",
        where="motor link",
        words="a byte of a request or a reply does not arrive",
        script={"kind": "drop", "on": "motor", "count": 1, "bytes": 1},
        ends=Ends.FINISHED,
        never=_SOUND,
    ),
    Fault(
        name="one message corrupted",
        where="motor link",
        words="a bit of a request or a reply flips",
        script={"kind": "corrupt", "on": "motor", "count": 1},
        ends=Ends.FINISHED,
        never=_SOUND,
    ),
    Fault(
        name="one message twice",
        where="motor link",
        words="a request or a reply arrives twice",
        script={"kind": "duplicate", "on": "motor", "count": 1},
        ends=Ends.FINISHED,
        never=_SOUND,
    ),
    Fault(
        name="one message late",
        where="motor link",
        words="a request or a reply arrives 0.15 s late",
        script={"kind": "delay", "on": "motor", "count": 1, "by": "0.15 s"},
        ends=Ends.FINISHED,
        never=_SOUND,
    ),
    Fault(
        name="noise",
        where="motor link",
        words="a bit flips in every tenth message, three times in all",
        script={"kind": "corrupt", "on": "motor", "share": 0.1, "count": 3},
        ends=Ends.FINISHED,
        never=_SOUND,
    ),
    Fault(
        name="silent",
        where="motor link",
        words="the controller hangs: it hears and says nothing",
        script={"kind": "silent", "on": "motor"},
        ends=Ends.LINK_LOST,
        says=_LINK,
    ),
    Fault(
        name="unplugged",
        where="motor link",
        words="the cable is pulled out",
        script={"kind": "disconnect", "on": "motor"},
        ends=Ends.LINK_LOST,
        says=_LINK,
    ),
    Fault(
        name="unplugged for 0.5 s",
        where="motor link",
        words="the cable is pulled out and put back",
        script={"kind": "disconnect", "on": "motor", "lasts": "0.5 s"},
        ends=Ends.STOPPED,
        says=_LINK,
    ),
    Fault(
        name="another device answers",
        where="motor link",
        words="a modem, or a web server",
        script={"kind": "wrong-device", "on": "motor"},
        ends=Ends.LINK_LOST,
        says=_LINK,
    ),
)

DRIVE = (
    Fault(
        name="drive trips",
        where="drive",
        words="the drive cuts its output and remembers a fault",
        script={"kind": "drive-fault", "code": 4},
        ends=Ends.STOPPED,
        says=_TRIP,
    ),
    Fault(
        name="speed stuck",
        where="drive",
        words="the shaft keeps its speed, the drive says it follows",
        script={"kind": "stuck-speed"},
        ends=Ends.STOPPED,
        says=r"(?i)not there|keyphasor reads|disagree|differ",
        window=(4.6, 6.2),  # on the ramp: while a speed is held nobody can tell
        stops_within=60.0,
    ),
)

DAQ = (
    Fault(
        name="one frame lost",
        where="DAQ",
        words="a frame does not arrive",
        script={"kind": "drop", "on": "daq", "direction": "from-device", "count": 1},
        ends=Ends.FINISHED,
        says=_GAP,
        never=_SOUND,
    ),
    Fault(
        name="bytes lost",
        where="DAQ",
        words="three bytes of a frame do not arrive",
        script={"kind": "drop", "on": "daq", "direction": "from-device", "count": 1, "bytes": 3},
        ends=Ends.FINISHED,
        says=_GAP,
        never=_SOUND,
    ),
    Fault(
        name="one frame corrupted",
        where="DAQ",
        words="a bit of a frame flips",
        script={"kind": "corrupt", "on": "daq", "direction": "from-device", "count": 1},
        ends=Ends.FINISHED,
        says=_GAP,
        never=_SOUND,
    ),
    Fault(
        name="one frame twice",
        where="DAQ",
        words="a frame arrives twice",
        script={"kind": "duplicate", "on": "daq", "direction": "from-device", "count": 1},
        ends=Ends.FINISHED,
        never=_SOUND,
    ),
    Fault(
        name="frames late",
        where="DAQ",
        words="frames arrive 0.3 s late for 1 s",
        script={"kind": "delay", "on": "daq", "direction": "from-device", "by": "0.3 s", "lasts": "1 s"},
        ends=Ends.FINISHED,
        never=_SOUND,
    ),
    Fault(
        name="overrun",
        where="DAQ",
        words="the board loses samples for 0.2 s, and says so",
        script={"kind": "daq-overrun", "lasts": "0.2 s"},
        ends=Ends.FINISHED,
        says=_GAP,
        never=_SOUND,
    ),
    Fault(
        name="silent",
        where="DAQ",
        words="the board hangs",
        script={"kind": "silent", "on": "daq"},
        ends=Ends.STOPPED,
        says=_LINK,
    ),
    Fault(
        name="unplugged",
        where="DAQ",
        words="the cable is pulled out",
        script={"kind": "disconnect", "on": "daq"},
        ends=Ends.STOPPED,
        says=_LINK,
    ),
    Fault(
        name="keyphasor lost",
        where="DAQ",
        words="the keyphasor's cable is off",
        script={"kind": "keyphasor-lost"},
        ends=Ends.STOPPED,
        says=r"(?i)keyphasor",
        window=(2.5, 10.0),  # at a speed: before the first pulses nobody misses them
    ),
)

PROGRAM = (
    Fault(name="kill -9", where="program", words="the program dies", signals=("SIGKILL",), ends=Ends.KILLED),
    Fault(
        name="frozen",
        where="program",
        words="the program hangs (SIGSTOP) until the rotor is at rest, then goes on",
        signals=("SIGSTOP", "SIGCONT"),
        ends=Ends.STOPPED,
        window=(1.5, 6.5),  # while the drive is told to run: a rotor that coasts stops all the same
        says=r"(?i)trip|lost|hung|silent|not running|stopped by itself",
    ),
    Fault(
        name="SIGTERM",
        where="program",
        words="the program is told to end",
        signals=("SIGTERM",),
        ends=Ends.INTERRUPTED,
        says=r"(?i)interrupted",
    ),
    Fault(
        name="Ctrl-C",
        where="program",
        words="the operator interrupts it",
        signals=("SIGINT",),
        ends=Ends.INTERRUPTED,
        says=r"(?i)interrupted",
    ),
    Fault(
        name="Ctrl-C twice",
        where="program",
        words="and once more, 0.2 s later",
        signals=("SIGINT", "SIGINT"),
        ends=Ends.INTERRUPTED,
        recorded=("emergency",),
        says=r"(?i)interrupted",
    ),
    Fault(
        name="disk full",
        where="program",
        words="the recording cannot grow any more",
        disk_full=True,
        ends=Ends.DISK_FULL,
        says=r"(?i)cannot be written|File too large",
    ),
)

FAULTS = (*MOTOR_LINK, *DRIVE, *DAQ, *PROGRAM)
