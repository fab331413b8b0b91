"""The unbalance that trial masses add, which a fit knows."""

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.measurement import SLOW_ROLL
from rotorrig.processing.response import OrderTrackedResponse


def trial_unbalance(response: OrderTrackedResponse, rows: NDArray[np.intp]) -> dict[str, NDArray[np.complex128]]:
    """Return the known added unbalance per disk, (row + 1,) kg m.

    That of the slow roll, last, is what its own run says; without such a run nothing was on.
    """
    runs = response.runs
    slow = next((run.trial_unbalance for run in runs if run.name == SLOW_ROLL), {})
    disks = dict.fromkeys(disk for run in runs for disk in run.trial_unbalance)
    per_run = {d: np.array([run.trial_unbalance.get(d, 0) for run in runs], dtype=complex) for d in disks}
    return {disk: np.append(amounts[response.run[rows]], slow.get(disk, 0)) for disk, amounts in per_run.items()}
