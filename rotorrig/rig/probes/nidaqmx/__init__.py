"""Analog inputs of National Instruments through NI-DAQmx: counts from its calibration, and the DAQ itself."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
