"""Proof test: every protection that software can provoke is provoked at slow roll, and its stop measured.

`proof.py` runs the parts, each a short sweep of its own; `protections/` holds one file for each; `stage.py` has the
instruments around the devices, `turns.py` what the samples say; `certificate.py` is the file that comes of it.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
