"""Waveforms from elsewhere.

CSV, universal files, TDMS and WAV, one file a format, by one mapping of channels to probes.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
