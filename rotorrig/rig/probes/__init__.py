"""Probe DAQs, all with the same verbs: open, start, read, close.

The framed serial stream, openDAQ and NI-DAQmx; and what every DAQ shares: blocks of raw counts, calibration, gap
tallies, the speed from the keyphasor.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
