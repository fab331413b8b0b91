"""Results as text, shared by terminal, report and viewer: quantities, causes, pulls, critical speeds, tracking."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
