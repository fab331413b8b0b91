"""The view of a result.

Measured and modelled vectors by speed, curves, cascade, the rotor's motion in 3D, the verdict.
"""

from rotorrig.app.viewer.result.opening import TIMELINE, read_opening
from rotorrig.app.viewer.result.view import write_result_rrd

__all__ = [
    "TIMELINE",
    "read_opening",
    "write_result_rrd",
]
