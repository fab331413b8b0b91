"""`fit.json` and `diagnosis.json`: plain JSON in SI, complex arrays as {"re": ..., "im": ...}, null for "not known".

Their keys are documented in docs/results.md and stable: readers may count on them.
"""

from rotorrig.identify.result_files.diagnosis_file import diagnosis_table, read_diagnosis, write_diagnosis
from rotorrig.identify.result_files.identification_file import (
    identification_table,
    read_identification,
    write_identification,
)
from rotorrig.identify.result_files.plain_json import (
    BALANCE,
    INVESTIGATION,
    PREDICTION,
    complex_in,
    complex_out,
    finite,
    infinite,
    number,
    numbers_in,
    numbers_out,
    read_table,
    write_table,
)

__all__ = [
    "BALANCE",
    "INVESTIGATION",
    "PREDICTION",
    "complex_in",
    "complex_out",
    "diagnosis_table",
    "finite",
    "identification_table",
    "infinite",
    "number",
    "numbers_in",
    "numbers_out",
    "read_diagnosis",
    "read_identification",
    "read_table",
    "write_diagnosis",
    "write_identification",
    "write_table",
]
