"""Physics of the simulated rig, blind to the identifier: hidden truth, shaft, faults, time integration, sensors, noise.

`draw` a `Truth` from a seed, `seal` it, and let a `Plant` advance in time.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
