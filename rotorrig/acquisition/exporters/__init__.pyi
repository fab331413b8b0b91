from .csv import write_csv as write_csv
from .uff import direction as direction
from .uff import write_uff as write_uff
from .uff58 import DISPLACEMENT as DISPLACEMENT
from .uff58 import ORDER as ORDER
from .uff58 import ORDER_FUNCTION as ORDER_FUNCTION
from .uff58 import RPM as RPM
from .uff58 import Axis as Axis
from .uff58 import Function as Function
from .uff58 import ascii_function as ascii_function
from .uff58 import units_in_si as units_in_si

__all__ = [
    "DISPLACEMENT",
    "ORDER",
    "ORDER_FUNCTION",
    "RPM",
    "Axis",
    "Function",
    "ascii_function",
    "direction",
    "units_in_si",
    "write_csv",
    "write_uff",
]
