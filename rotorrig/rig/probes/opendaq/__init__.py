"""Devices of the openDAQ SDK: settings, counts, packets placed by their clock ticks, channels assembled to scans."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
