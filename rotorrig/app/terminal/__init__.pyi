from .console import err as err
from .console import out as out
from .console import progress_bars as progress_bars
from .console import tell as tell
from .console import working as working
from .model_drawing import draw_rotor as draw_rotor
from .operator import HINT as HINT
from .operator import confirm as confirm
from .operator import operator_for as operator_for
from .proof_table import proof_table as proof_table

__all__ = [
    "HINT",
    "confirm",
    "draw_rotor",
    "err",
    "operator_for",
    "out",
    "progress_bars",
    "proof_table",
    "tell",
    "working",
]
