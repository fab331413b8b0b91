"""Emulated motor controllers, one file each, from the manuals and not from the drivers' frames."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
