from .channel_mapping import load_channels as load_channels
from .csv import read_csv as read_csv
from .tdms import read_tdms as read_tdms
from .uff import read_uff as read_uff
from .wav import read_wav as read_wav

__all__ = [
    "load_channels",
    "read_csv",
    "read_tdms",
    "read_uff",
    "read_wav",
]
