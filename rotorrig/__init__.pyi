from .app.lab import query as query
from .app.python import Balance as Balance
from .app.python import Diagnosis as Diagnosis
from .app.python import Identification as Identification
from .app.python import Prediction as Prediction
from .app.python import Recording as Recording
from .app.python import Response as Response
from .app.python import Rotor as Rotor
from .app.python import balance as balance
from .app.python import diagnose as diagnose
from .app.python import identify as identify
from .app.python import predict as predict
from .app.python import read as read
from .app.python import report as report
from .app.python import simulate as simulate
from .app.python import track as track
from .rig.errors import ConfigError as ConfigError
from .rig.errors import DataError as DataError
from .rig.errors import RigError as RigError

__all__ = [
    "Balance",
    "ConfigError",
    "DataError",
    "Diagnosis",
    "Identification",
    "Prediction",
    "Recording",
    "Response",
    "RigError",
    "Rotor",
    "balance",
    "diagnose",
    "identify",
    "predict",
    "query",
    "read",
    "report",
    "simulate",
    "track",
]
