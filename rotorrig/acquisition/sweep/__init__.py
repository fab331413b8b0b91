"""A sweep in operation: a plan's steps, the per-block loop that checks, records and shows, and the way back to rest.

`plans.py` yields `Ramp`, `Dwell`, `Coast` ...; `engine.py` runs them; `session.py` handles each block;
`run_down.py` follows the rotor until `rest.py` has proof that it is at rest, and stops it harder until then. The motor
is behind `rig.control`, whose guardian stops the rotor if this process cannot.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
