"""The framed serial stream of docs/daq-stream.md: its bytes, its port, the order of its frames, and the DAQ itself."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
