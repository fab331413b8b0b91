"""Cables of the simulated rig: ptys and TCP bridged with line speed, noise and breaks."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
