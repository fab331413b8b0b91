"""Numbers as people read them."""

import dataclasses

import numpy as np

from rotorrig.app.text.quantities import estimate_text, quantity_text
from rotorrig.identify.identification import Estimate


def test_numbers_carry_no_more_digits_than_their_uncertainty() -> None:
    estimate = Estimate(name="kxx", value=33912.7, sigma=1234.0, unit="N/m", nameplate=33900.0)
    assert estimate_text(estimate) == "33.9 ± 1.2 kN/m"
    assert (
        estimate_text(dataclasses.replace(estimate, value=0.0031, sigma=0.0052, unit="", nameplate=0.0))
        == "0.31 ± 0.52 %"
    )
    assert quantity_text(np.radians(40.0), "rad") == "40°"
