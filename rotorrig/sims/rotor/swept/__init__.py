"""The response while the speed changes, as a tracked sweep sees it.

Modes stepped from turn to turn, windowed averages.
"""

from rotorrig.sims.rotor.swept.envelope import polynomial
from rotorrig.sims.rotor.swept.forcing import drive
from rotorrig.sims.rotor.swept.passed_modes import Passage, Spectra, passage
from rotorrig.sims.rotor.swept.passed_modes_derivatives import passage_derivatives
from rotorrig.sims.rotor.swept.swept_modes import passing
from rotorrig.sims.rotor.swept.swept_response import projected, swept_columns, swept_derivatives
from rotorrig.sims.rotor.swept.time_stepping import SMOOTH, STRAIGHT, add_matrix, invert
from rotorrig.sims.rotor.swept.timeline import TURN, Timeline
from rotorrig.sims.rotor.swept.tracking_windows import TrackedRows, tracked_rows, window_weights

__all__ = [
    "SMOOTH",
    "STRAIGHT",
    "TURN",
    "Passage",
    "Spectra",
    "Timeline",
    "TrackedRows",
    "add_matrix",
    "drive",
    "invert",
    "passage",
    "passage_derivatives",
    "passing",
    "polynomial",
    "projected",
    "swept_columns",
    "swept_derivatives",
    "tracked_rows",
    "window_weights",
]
