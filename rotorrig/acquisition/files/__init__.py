"""Recording files: MCAP with protobuf messages, written so that a crash costs little, read whole or on demand.

`recording_mcap.py` is what others use; below it stand the container (chunks, index, salvage), the schemas and messages,
and the fsync thread.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
