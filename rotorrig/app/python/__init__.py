"""What `import rotorrig as rr` gives: files read by their content, verbs as functions, results as tables.

`read` returns a `Recording`, a `Response`, an `Identification`, a `Diagnosis`, a `Balance` or a `Rotor`, whatever the
file is. These are the types of the stages with a short repr, an HTML one for notebooks, and their ways into pandas,
xarray and Plotly.
"""

from rotorrig.app.python.balancing import Balance, Prediction, balance, predict
from rotorrig.app.python.read import read
from rotorrig.app.python.recording import Recording
from rotorrig.app.python.response import Response
from rotorrig.app.python.results import Diagnosis, Identification
from rotorrig.app.python.rotor import Rotor
from rotorrig.app.python.verbs import diagnose, identify, report, simulate, track

__all__ = [
    "Balance",
    "Diagnosis",
    "Identification",
    "Prediction",
    "Recording",
    "Response",
    "Rotor",
    "balance",
    "diagnose",
    "identify",
    "predict",
    "read",
    "report",
    "simulate",
    "track",
]
