"""The unbalance that trial masses add, which a fit knows."""

import numpy as np
from numpy.typing import NDArray

from rotorrig.processing.response import OrderTrackedResponse


def trial_unbalance(response: OrderTrackedResponse, rows: NDArray[np.intp]) -> dict[str, NDArray[np.complex128]]:
    """Return the known added unbalance per disk, (row + 1,) kg m; the slow roll, last, is a run without."""
    disks = dict.fromkeys(disk for run in response.runs for disk in run.trial_unbalance)
    per_run = {d: np.array([run.trial_unbalance.get(d, 0) for run in response.runs], dtype=complex) for d in disks}
    return {disk: np.append(amounts[response.run[rows]], 0) for disk, amounts in per_run.items()}
