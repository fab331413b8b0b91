"""Sweeps and recordings: run a sweep on a rig, keep every sample as MCAP, import foreign files, export, replay.

`sweep` runs a plan under its interlocks, `files` holds the recording's format, `importers` and `exporters` the formats
of others, `replay.py` plays a recording back block by block. What passes from here to processing is a `RawRecording`,
or one left in its file: a `WaveformSource`.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
