from .critical_speeds import Band as Band
from .critical_speeds import critical_bands as critical_bands
from .engine import RUN_DOWN_LIMIT as RUN_DOWN_LIMIT
from .engine import SweepInterrupted as SweepInterrupted
from .engine import SweepResult as SweepResult
from .engine import reading_interval as reading_interval
from .engine import run_sweep as run_sweep
from .operator import Operator as Operator
from .plans import SETTLING_RAMP as SETTLING_RAMP
from .plans import draft_sweep as draft_sweep
from .plans import objections as objections
from .plans import plan_sweep as plan_sweep
from .rest import RotorState as RotorState
from .run_down import RunDown as RunDown
from .steps import Ask as Ask
from .steps import Coast as Coast
from .steps import Dwell as Dwell
from .steps import Mark as Mark
from .steps import Provoke as Provoke
from .steps import Ramp as Ramp
from .steps import Rest as Rest
from .steps import Step as Step
from .steps import Trial as Trial
from .stop_only import NoRecording as NoRecording
from .stop_only import bring_to_rest as bring_to_rest
from .stop_only import stop_unseen as stop_unseen
from .timeline import COAST_SECONDS as COAST_SECONDS
from .timeline import TimedStep as TimedStep
from .timeline import plan_timeline as plan_timeline

__all__ = [
    "COAST_SECONDS",
    "RUN_DOWN_LIMIT",
    "SETTLING_RAMP",
    "Ask",
    "Band",
    "Coast",
    "Dwell",
    "Mark",
    "NoRecording",
    "Operator",
    "Provoke",
    "Ramp",
    "Rest",
    "RotorState",
    "RunDown",
    "Step",
    "SweepInterrupted",
    "SweepResult",
    "TimedStep",
    "Trial",
    "bring_to_rest",
    "critical_bands",
    "draft_sweep",
    "objections",
    "plan_sweep",
    "plan_timeline",
    "reading_interval",
    "run_sweep",
    "stop_unseen",
]
