from .balance_tables import comparison_table as comparison_table
from .balance_tables import corrections_table as corrections_table
from .balance_tables import prediction_table as prediction_table
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
from .rig_table import rig_table as rig_table
from .rows_table import rows_table as rows_table

__all__ = [
    "HINT",
    "comparison_table",
    "confirm",
    "corrections_table",
    "draw_rotor",
    "err",
    "operator_for",
    "out",
    "prediction_table",
    "progress_bars",
    "proof_table",
    "rig_table",
    "rows_table",
    "tell",
    "working",
]
