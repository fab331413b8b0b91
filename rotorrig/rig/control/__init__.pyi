from .base import LOOP_STALL as LOOP_STALL
from .base import READ_EVERY as READ_EVERY
from .base import Command as Command
from .base import MotorControl as MotorControl
from .base import Reading as Reading
from .base import SetSpeed as SetSpeed
from .base import StopForNow as StopForNow
from .base import StopReport as StopReport
from .direct import DirectControl as DirectControl
from .guarded import PATIENCE as PATIENCE
from .guarded import PERSIST as PERSIST
from .guarded import GuardedControl as GuardedControl
from .ladder import Ladder as Ladder
from .ladder import Measure as Measure
from .power_cut import cut_power as cut_power
from .registry import ask_guardian as ask_guardian
from .registry import guardian_log as guardian_log
from .threaded import ThreadedControl as ThreadedControl

__all__ = [
    "LOOP_STALL",
    "PATIENCE",
    "PERSIST",
    "READ_EVERY",
    "Command",
    "DirectControl",
    "GuardedControl",
    "Ladder",
    "Measure",
    "MotorControl",
    "Reading",
    "SetSpeed",
    "StopForNow",
    "StopReport",
    "ThreadedControl",
    "ask_guardian",
    "cut_power",
    "guardian_log",
]
