from .recording import Event as Event
from .recording import MotorSample as MotorSample
from .recording import RawRecording as RawRecording
from .recording import Recorded as Recorded
from .replay import ReplayDaq as ReplayDaq
from .replay import cut_from as cut_from

__all__ = [
    "Event",
    "MotorSample",
    "RawRecording",
    "Recorded",
    "ReplayDaq",
    "cut_from",
]
