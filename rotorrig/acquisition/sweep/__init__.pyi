from .engine import SweepResult as SweepResult
from .engine import run_sweep as run_sweep
from .operator import Operator as Operator
from .steps import Ask as Ask
from .steps import Coast as Coast
from .steps import Dwell as Dwell
from .steps import Mark as Mark
from .steps import Ramp as Ramp
from .steps import Rest as Rest
from .steps import Step as Step
from .steps import Trial as Trial
from .timeline import COAST_SECONDS as COAST_SECONDS
from .timeline import Timed as Timed
from .timeline import plan_timeline as plan_timeline

__all__ = [
    "COAST_SECONDS",
    "Ask",
    "Coast",
    "Dwell",
    "Mark",
    "Operator",
    "Ramp",
    "Rest",
    "Step",
    "SweepResult",
    "Timed",
    "Trial",
    "plan_timeline",
    "run_sweep",
]
