"""Result of a search: scipy's `OptimizeResult`, with everything found even when it was cut short."""

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import OptimizeResult

from rotorrig.identify.chea.session.record import Record, Stage
from rotorrig.identify.chea.session.state import SearchState
from rotorrig.identify.chea.session.stopping import StopReason

Array = NDArray[np.float64]


class CheaResult(OptimizeResult):
    """Result of a search. However it ended, x is the best point evaluated and xl what was found until then."""

    x: Array  # (dim,); NaN if fun never gave a finite value
    fun: float
    success: bool  # converged or at the target; no proof that x is the global minimum
    status: int  # position of stop_reason in its enumeration
    stop_reason: StopReason
    message: str
    nfev: int  # values of fun, points of a batch counted one by one, finite differences included
    njev: int  # gradients taken by finite differences
    nit: int  # generations, local searches and far searches
    nfail: int  # calls that raised or gave no finite value
    xl: Array  # (n, dim) minima: ends of local searches, each once, best first
    funl: Array  # (n,)
    hits: NDArray[np.intp]  # (n,) how many local searches ended there
    stages: tuple[Stage, ...]  # what each kind of step did, in the order they began
    heads: Array  # (n, dim) best points of the clusters that were searched
    reduced: int  # clusters that were not convex, in whose bounds points were gathered again
    history: Array  # (m, 2) nfev and best value at every improvement
    state: SearchState  # to be resumed


def assemble(record: Record, state: SearchState, reason: StopReason) -> CheaResult:
    """Return the result of a search, ended for `reason`."""
    u, funl, hits = record.minima.sorted()
    best_u, best = record.best
    result = CheaResult()
    result.update(
        x=state.scaling.to_parameters(best_u),
        fun=best,
        success=reason in (StopReason.CONVERGED, StopReason.TARGET),
        status=reason.status,
        stop_reason=reason,
        message=_message(record, state.failure, reason),
        nfev=record.nfev,
        njev=record.njev,
        nit=record.nit,
        nfail=record.failures,
        xl=state.scaling.to_parameters(u),
        funl=funl,
        hits=hits,
        stages=record.stages,
        heads=state.scaling.to_parameters(np.array(record.heads).reshape(-1, record.dim)),
        reduced=record.reduced,
        history=np.array(record.history, dtype=np.float64).reshape(-1, 2),
        state=state,
    )
    return result


def _message(record: Record, failure: str, reason: StopReason) -> str:
    evaluations, minima = _count(record.nfev, "evaluation"), _count(len(record.minima), "minimum", "minima")
    words = f"{reason.value.capitalize()} after {evaluations}, {minima} found."
    if record.failures:
        words += f" fun failed at {_count(record.failures, 'point')}"
        words += f", at first with: {failure}." if failure else "."
    return words


def _count(n: int, one: str, many: str = "") -> str:
    return f"{n} {one if n == 1 else many or one + 's'}"
