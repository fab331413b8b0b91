"""Find the slow roll of a recording and add it to the response: vector, waveform and what speaks against it.

The rows are those of the run named "slow roll", a dwell; or, where a window of speed was chosen, those within it, of a
run-up or coast-down for instance. A dwell that is none (its speed varies, its rows scatter) loses its rows, as it does
not measure one vector; the vector is kept with the covariance that it then has. All else that speaks against a slow
roll is a remark, and the rows of a window stay rows of their run.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.processing.rows import Rows
from rotorrig.processing.shaft_angle import ShaftAngle
from rotorrig.processing.slow_roll import vector as slow_roll
from rotorrig.processing.slow_roll.checks import FirstOrder, validity_remarks
from rotorrig.processing.slow_roll.waveform import slow_roll_waveform
from rotorrig.processing.waveform import Waveforms
from rotorrig.rig import DataError
from rotorrig.rig.config import RPM

NAME = "slow roll"  # of the run that is one


def add_slow_roll(
    response: OrderTrackedResponse,
    waveforms: Waveforms,
    shaft: ShaftAngle,
    rows: Rows,
    *,
    window: tuple[float, float] | None = None,
) -> OrderTrackedResponse:
    """Return the response with its slow roll, without one if there is none.

    `window` are the lowest and the highest speed [rad/s] of its rows, None: the run of that name. Raises DataError if
    no row is within the window.
    """
    chosen = chosen_rows(response, window=window)
    if not chosen.any():
        return response
    slow = slow_roll.estimate(
        response.z[chosen],
        response.covariance[chosen],
        response.omega[chosen],
        usable=response.usable[chosen],
        dwell=window is None,
    )
    first = FirstOrder.of(response, chosen)
    response = replace(
        response,
        slow_roll=slow.z,
        slow_roll_covariance=slow.covariance,
        slow_roll_omega=slow.omega,
        slow_roll_waveform=slow_roll_waveform(waveforms, shaft, rows, slow, chosen=chosen),
        slow_roll_remarks=slow.remarks + (validity_remarks(first, slow) if first else ()),
    )
    return _mask_rows(response, chosen, slow.remarks) if window is None and slow.remarks else response


def chosen_rows(response: OrderTrackedResponse, *, window: tuple[float, float] | None = None) -> NDArray[np.bool_]:
    """Return the mask (row,) of rows that are the slow roll.

    Within a window only runs count that had the same trial masses on as the first of them: another unbalance is
    another vector. Raises DataError if no row is within the window.
    """
    runs, omega = response.runs, response.omega
    if window is None:
        return np.isin(response.run, [i for i, run in enumerate(runs) if run.name == NAME])
    low, high = window
    inside = (omega >= low) & (omega <= high)
    if not inside.any():
        raise DataError(
            f"{response.source.source or 'recording'}: no row is between {low * RPM:.0f} and {high * RPM:.0f} rpm, "
            f"want a slow-roll window within {omega.min() * RPM:.0f} to {omega.max() * RPM:.0f} rpm"
        )
    trial = runs[response.run[inside.argmax()]].trial_unbalance
    alike = np.array([run.trial_unbalance == trial for run in runs])
    return np.asarray(inside & alike[response.run])


def _mask_rows(
    response: OrderTrackedResponse, rows: NDArray[np.bool_], remarks: tuple[str, ...]
) -> OrderTrackedResponse:
    """Return the response with `rows` masked, `remarks` as the reasons."""
    reasons = tuple((*row, *remarks) if out else row for row, out in zip(response.reasons, rows, strict=True))
    return replace(response, usable=response.usable & ~rows[:, None], reasons=reasons)
