"""A response told by a shaft angle that falls: how a model that turns one way sees a rotor that turned the other."""

from dataclasses import replace

import numpy as np

from rotorrig.processing import OrderTrackedResponse


def told_by_falling_angle(response: OrderTrackedResponse) -> OrderTrackedResponse:
    """Return a response told as of the rig that turns the other way, x = Re(z e^{j n theta}) with an angle that falls.

    Angles of trial masses are then in that rig's sense of rotation.
    """
    sign = np.resize([1.0, -1.0], response.covariance.shape[-1])
    flipped = np.outer(sign, sign)
    return replace(
        response,
        rig=response.rig.turned_over,
        runs=tuple(
            replace(run, trial_unbalance={disk: np.conj(u) for disk, u in run.trial_unbalance.items()})
            for run in response.runs
        ),
        z=response.z.conj(),
        covariance=response.covariance * flipped,
        slow_roll=response.slow_roll.conj(),
        slow_roll_covariance=response.slow_roll_covariance * flipped,
    )
