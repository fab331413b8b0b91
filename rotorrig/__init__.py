"""Acquisition and identification for a rotor test rig; the README's Conventions hold throughout.

`import rotorrig as rr` gives `rr.read`, `rr.track`, `rr.identify`, `rr.diagnose`, `rr.balance`, `rr.predict`,
`rr.report`, `rr.simulate`, `rr.Rotor` and `rr.query` (docs/python.md). Nothing is loaded before it is asked for.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
