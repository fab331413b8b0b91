"""`fit.json` and `diagnosis.json`: plain JSON in SI, complex arrays as {"re": ..., "im": ...}, null for "not known".

Their keys are documented in docs/results.md and stable: readers may count on them.
"""

from rotorrig.identify.result_files.diagnosis_file import diagnosis_table, read_diagnosis, write_diagnosis
from rotorrig.identify.result_files.identification_file import (
    identification_table,
    read_identification,
    write_identification,
)

__all__ = [
    "diagnosis_table",
    "identification_table",
    "read_diagnosis",
    "read_identification",
    "write_diagnosis",
    "write_identification",
]
