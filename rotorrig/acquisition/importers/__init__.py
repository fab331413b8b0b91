"""Import of waveforms: CSV, universal files, TDMS and WAV, one file a format, one mapping of channels to probes."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
