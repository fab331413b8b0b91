"""What a search returns: scipy's `OptimizeResult`, with everything found even when it was cut short."""

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import OptimizeResult

from rotorrig.identify.chea.ledger import Ledger
from rotorrig.identify.chea.minima import Minima
from rotorrig.identify.chea.stopping import StopReason

Array = NDArray[np.float64]


class CheaResult(OptimizeResult):
    """What `chea` found. In all cases of ending, x is the best point evaluated and xl what was found until then."""

    x: Array  # (dim,); NaN if fun never gave a finite value
    fun: float
    success: bool  # converged or at the target; no proof that x is the global minimum
    status: int  # position of stop_reason in its enumeration
    stop_reason: StopReason
    message: str
    nfev: int  # calls of fun, points of a batch counted one by one, finite differences included
    nit: int  # generations, local searches and far searches
    nfail: int  # calls that raised or gave no finite value
    xl: Array  # (n, dim) ends of local searches, each once, best first
    funl: Array  # (n,)
    history: Array  # (m, 2) nfev and best value at every improvement


def assemble(ledger: Ledger, minima: Minima, reason: StopReason) -> CheaResult:
    """Return the result of a search, ended for `reason`."""
    u, funl = minima.sorted(ledger.scaling.dim)
    result = CheaResult()
    result.update(
        x=ledger.best_x,
        fun=ledger.best_fun,
        success=reason in (StopReason.CONVERGED, StopReason.TARGET),
        status=reason.status,
        stop_reason=reason,
        message=_message(ledger, len(funl), reason),
        nfev=ledger.nfev,
        nit=ledger.nit,
        nfail=ledger.failures,
        xl=ledger.scaling.to_parameters(u),
        funl=funl,
        history=np.array(ledger.history, dtype=np.float64).reshape(-1, 2),
    )
    return result


def _message(ledger: Ledger, minima: int, reason: StopReason) -> str:
    words = f"{reason.value.capitalize()} after {ledger.nfev} evaluations, {minima} minima found."
    if ledger.failures:
        words += f" fun failed at {ledger.failures} of the points, at first with: {ledger.first_failure}."
    return words
