"""One run of CHEA: its state and resume, the record of calls, scaling, stop rules, the list of minima, the result."""

from rotorrig.identify.chea.session.minima import Minima, one_point
from rotorrig.identify.chea.session.record import Evaluations, Record, Stage
from rotorrig.identify.chea.session.result import CheaResult, assemble
from rotorrig.identify.chea.session.scaling import Box, from_bounds
from rotorrig.identify.chea.session.state import SearchState
from rotorrig.identify.chea.session.stopping import Stop, StopReason

__all__ = [
    "Box",
    "CheaResult",
    "Evaluations",
    "Minima",
    "Record",
    "SearchState",
    "Stage",
    "Stop",
    "StopReason",
    "assemble",
    "from_bounds",
    "one_point",
]
