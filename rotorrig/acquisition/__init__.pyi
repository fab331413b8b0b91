from .recording import Event as Event
from .recording import MotorSample as MotorSample
from .recording import RawRecording as RawRecording
from .recording import WaveformSource as WaveformSource
from .replay import ReplayDaq as ReplayDaq
from .replay import trim_before as trim_before

__all__ = [
    "Event",
    "MotorSample",
    "RawRecording",
    "ReplayDaq",
    "WaveformSource",
    "trim_before",
]
