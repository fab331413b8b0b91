"""A rig and its devices.

Configs, motor drivers, probe DAQs, interlocks, exchange with ROSS; errors, clock, provenance.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
