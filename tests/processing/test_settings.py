"""What may be asked of the tracking, and the sentence for what may not."""

import numpy as np
import pytest

from rotorrig.processing.settings import Spacing, SpeedWindow, Tracking, read_orders
from rotorrig.rig.errors import ConfigError

RPM = np.pi / 30


def test_orders_become_numbers_and_the_usual_needs_no_words() -> None:
    assert Tracking(orders=(0, 1)).orders == (0.0, 1.0)  # type: ignore[arg-type]
    assert Tracking().orders == (0.0, 0.5, 1.0, 2.0, 3.0)
    assert Tracking().method == "resampling"


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"method": "fft"}, "method: got 'fft', want one of resampling, least-squares, vold-kalman"),
        ({"turns": 0}, "turns: got 0, want a whole number from 1"),
        ({"turns": 2.5}, "turns: got 2.5, want a whole number"),
        ({"orders": ()}, "orders: got none, want one or more"),
        ({"orders": (1.0, 2.0, 1.0)}, "orders: got 1, 2, 1, want one or more, each once"),
        ({"orders": (np.nan,)}, "orders: got nan, want none above 100"),
        ({"turns": 2, "orders": (0.5,)}, r"cannot tell order 0\.5 from its neighbours, want turns = 6"),
        ({"orders": (0.4, 0.5)}, r"cannot tell order 0\.4 from its neighbours, want turns = 30"),
        ({"turns": 10, "orders": (0.47,)}, r"want turns = 100 or a multiple of it, or the method least-squares"),
        ({"turns": 8, "orders": (0.05,), "method": "least-squares"}, r"want turns = 20 or a multiple"),
    ],
)
def test_what_no_recording_can_be_tracked_with_is_said(settings: dict, words: str) -> None:
    with pytest.raises(ConfigError, match=words):
        Tracking(**settings)


def test_a_fit_tells_orders_apart_in_half_the_turns_and_wants_no_whole_periods() -> None:
    for method in ("least-squares", "vold-kalman"):
        assert Tracking(turns=4, orders=(0.47, 1.0), method=method).turns == 4
    with pytest.raises(ConfigError):
        Tracking(turns=4, orders=(0.47, 1.0))


def test_a_spacing_is_read_in_speed_or_time() -> None:
    assert Spacing.read("10 rpm", where="--every").step == pytest.approx(10 * RPM)
    assert Spacing.read("10 rpm", where="--every").of == "speed"
    assert Spacing.read("0.5 s", where="--every") == Spacing(of="time", step=0.5)
    for text in ("10", "0 rpm", "-1 s", "1 mm", "", "nan s"):
        with pytest.raises(ConfigError, match=r"--every: got .* want a step of speed or time"):
            Spacing.read(text, where="--every")


def test_a_speed_window_is_read_with_one_unit_or_two() -> None:
    for text in ("200 to 400 rpm", "200 rpm to 400 rpm"):
        assert SpeedWindow.read(text, where="--slow-roll") == pytest.approx((200 * RPM, 400 * RPM))
    for text in ("400 to 200 rpm", "300 rpm", "200 to 400 Hz", "a to b", "200 to 400"):
        with pytest.raises(ConfigError, match="--slow-roll: got "):
            SpeedWindow.read(text, where="--slow-roll")


def test_orders_are_read_as_people_write_them() -> None:
    assert read_orders("0, 0.5,1X, -1", where="--orders") == (0.0, 0.5, 1.0, -1.0)
    with pytest.raises(ConfigError, match="--orders: got '1;2', want numbers such as"):
        read_orders("1;2", where="--orders")


def test_operating_speeds_are_one_or_two() -> None:
    assert SpeedWindow.read_one_or_two("30 rad/s", where="--operating-speed") == (30.0, 30.0)
    assert SpeedWindow.read_one_or_two("20 to 30 rad/s", where="--operating-speed") == (20.0, 30.0)
    for wrong in ("3000", "fast", "-10 rpm", "0 rpm", "30 to 20 rad/s"):
        with pytest.raises(ConfigError, match="--operating-speed: got"):
            SpeedWindow.read_one_or_two(wrong, where="--operating-speed")
