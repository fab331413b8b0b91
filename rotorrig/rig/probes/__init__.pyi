from .base import Block as Block
from .base import Daq as Daq
from .base import DaqCounters as DaqCounters
from .base import DaqInfo as DaqInfo
from .calibration import ProbeScale as ProbeScale
from .calibration import channel_volts as channel_volts
from .calibration import channels_used as channels_used
from .keyphasor_speed import KeyphasorSpeed as KeyphasorSpeed
from .lost_daq import LostDaq as LostDaq
from .nidaqmx import NiDaqmxDaq as NiDaqmxDaq
from .opendaq import OpenDaqDaq as OpenDaqDaq
from .stream import StreamDaq as StreamDaq

__all__ = [
    "Block",
    "Daq",
    "DaqCounters",
    "DaqInfo",
    "KeyphasorSpeed",
    "LostDaq",
    "NiDaqmxDaq",
    "OpenDaqDaq",
    "ProbeScale",
    "StreamDaq",
    "channel_volts",
    "channels_used",
]
