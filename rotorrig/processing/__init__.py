"""Waveforms to vectors over speed: shaft angle from the keyphasor, order tracking, noise, slow roll; `response.mcap`.

`track` (pipeline.py) runs the steps, each a folder: `shaft_angle`, `rows` (which revolutions make a row), `tracking`
(three methods), `noise` (covariance), `slow_roll`, `files`. What passes on to identify is an `OrderTrackedResponse`.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
