"""Text with a unit becomes SI; anything a person could get wrong is refused in one sentence."""

import math

import pytest

from rotorrig.rig.config.units import QUANTITIES, micrometres, to_si


@pytest.mark.parametrize(
    ("text", "quantity", "value"),
    [
        ("33.9 kN/m", "stiffness", 33900.0),
        ("10 mm", "length", 0.01),
        ("200 g mm", "unbalance", 200e-6),
        ("480 rpm", "speed", 480 * 2 * math.pi / 60),
        ("30 rpm/s", "ramp", math.pi),
        ("7.874 mV/um", "sensitivity", 7874.0),
        ("-10 V", "voltage", -10.0),
        ("45 deg", "angle", math.pi / 4),
        ("568.46e-6 kg m^2", "inertia", 568.46e-6),
        ("1 lbf/inch", "stiffness", 4.4482216152605 / 0.0254),
        ("2 mil", "length", 50.8e-6),
        ("3 mils", "length", 76.2e-6),
        ("200 mV/mil", "sensitivity", 200e-3 / 25.4e-6),
    ],
)
def test_text_is_read_in_si(text: str, quantity: str, value: float) -> None:
    assert to_si(text, quantity) == pytest.approx(value, rel=1e-12)


@pytest.mark.parametrize("quantity", QUANTITIES)
def test_every_example_shown_in_errors_is_itself_valid(quantity: str) -> None:
    assert math.isfinite(to_si(QUANTITIES[quantity][1], quantity))


@pytest.mark.parametrize(
    ("text", "quantity", "said"),
    [
        (33.9, "stiffness", "got 33.9, want a stiffness with its unit"),
        ("33.9", "stiffness", "without a unit"),
        ("33.9 kN", "stiffness", "got '33.9 kN'"),
        ("10 furlongz", "length", "no number with a unit"),
        ("10 mm(", "length", "no number with a unit"),
        ("60 Hz", "speed", "Hz could mean either"),
        ("600 rpm", "rate", "want a rate in Hz"),
        ("3 percent", "stiffness", "want a stiffness"),
        ("nan mm", "length", "want a length"),
        ("", "length", "want a length"),
        ("45", "angle", "without a unit"),
        (True, "length", "want a length"),
    ],
)
def test_anything_else_is_refused_in_one_sentence(text: object, quantity: str, said: str) -> None:
    with pytest.raises(ValueError, match=r".") as caught:
        to_si(text, quantity)
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("length", "said"), [(3.94e-7, "0.39"), (2.4e-6, "2.4"), (-55e-6, "-55"), (152.4e-6, "152"), (1.2e-3, "1200")]
)
def test_a_length_in_a_sentence_has_no_exponent(length: float, said: str) -> None:
    assert micrometres(length) == said
