"""Motor control during a sweep: commands, readings, stops that are tried until the drive obeys.

`base.py` is the interface; `threaded.py` runs it on threads; `guarded.py` in a process that outlives this one, which is
`guardian.py`; `direct.py` in the caller's thread, for tests; `ladder.py` says which stop comes next when one does not
help; `power_cut.py` runs what cuts the drive's power.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
