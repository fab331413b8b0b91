"""Motor controllers, all with the same verbs: open, read, set_speed, stop, close.

Modbus RTU and TCP, CiA 402 over CAN, and the line protocol. The bytes are pure functions in `*_frames.py`; `profiles`
holds one file a Modbus drive.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
