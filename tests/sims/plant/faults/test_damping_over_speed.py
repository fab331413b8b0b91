"""A damper that fills with speed."""

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig

from ..by_hand import growth

FILM = {"damping": 20.0, "reference": 250.0}
MATERIAL = 3e-6 * 73.631e3  # N s/m of the shaft's own, which turns with it


@pytest.mark.parametrize(("omega", "filled"), [(0.0, 0.0), (125.0, 0.2), (250.0, 0.5), (500.0, 0.8)])
def test_a_whirl_dies_out_faster_the_faster_the_shaft_turns(jeffcott: RigConfig, omega: float, filled: float) -> None:
    """Of 1 kg on c = 27.13 N s/m and as much of the film as s^2 / (1 + s^2) is filled: as e^(-c t / 2 m)."""
    rates = [growth(jeffcott, "damping_over_speed", FILM, omega=omega, forward=forward) for forward in (True, False)]
    damping = 27.13 + 20.0 * filled + MATERIAL
    carried = MATERIAL * omega / np.sqrt(73.631e3)
    assert rates == pytest.approx([-(damping - carried) / 2, -(damping + carried) / 2], rel=0.02)
