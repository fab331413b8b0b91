"""The simulated rig behind real wires: emulated controllers and DAQ on ptys and TCP, scripted faults, one process."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
