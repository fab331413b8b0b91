from .base_fit import BaseProblem as BaseProblem
from .base_fit import config_effects as config_effects
from .base_fit.fit import identify as identify
from .diagnosis import Diagnosis as Diagnosis
from .diagnosis import Verdict as Verdict
from .diagnosis import diagnose as diagnose
from .identification import Deviation as Deviation
from .identification import Estimate as Estimate
from .identification import Fit as Fit
from .identification import Identification as Identification
from .identification import ModelResonance as ModelResonance
from .identification import NameplateCheck as NameplateCheck
from .result_files import diagnosis_table as diagnosis_table
from .result_files import identification_table as identification_table
from .result_files import read_diagnosis as read_diagnosis
from .result_files import read_identification as read_identification
from .result_files import write_diagnosis as write_diagnosis
from .result_files import write_identification as write_identification

__all__ = [
    "BaseProblem",
    "Deviation",
    "Diagnosis",
    "Estimate",
    "Fit",
    "Identification",
    "ModelResonance",
    "NameplateCheck",
    "Verdict",
    "config_effects",
    "diagnose",
    "diagnosis_table",
    "identification_table",
    "identify",
    "read_diagnosis",
    "read_identification",
    "write_diagnosis",
    "write_identification",
]
