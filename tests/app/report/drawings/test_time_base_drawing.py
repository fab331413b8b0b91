"""The picture of four turns whose numbers are given."""

import re

import numpy as np

from rotorrig.app.plot_data.time_bases import TimeBase
from rotorrig.app.report.drawings.time_base_drawing import time_base_picture
from rotorrig.processing.probe_planes import Plane

ANGLE = 2 * np.pi * np.arange(0, 4, 1 / 50)


def picture(*, raw_radius: float = 20.0) -> str:
    """A circle of 20 um from +x towards +y at 3000 rpm, and one of 10 um at 1X."""
    circle = np.column_stack([np.cos(ANGLE), np.sin(ANGLE)])
    base = TimeBase(
        plane=Plane(position=0.1, probes=("a", "b"), to_xy=np.eye(2)),
        speed="top speed",
        rpm=3000.0,
        t=ANGLE / (2 * np.pi) * 20.0,
        raw=raw_radius * circle,
        filtered=10.0 * circle,
        edges=20.0 * np.arange(5.0),
    )
    return time_base_picture(base)


def lines(html: str, kind: str) -> list[np.ndarray]:
    """The points of every path of a kind, in drawing units."""
    found = re.findall(rf'<path class="{kind}" d="M(-?\d+) (-?\d+)l([^"]*)"', html)
    return [
        np.cumsum(
            [[int(x), int(y)], *([int(step[0]), int(step[1])] for step in re.findall(r"(-?\d+)([+-]\d+)", moves))],
            axis=0,
        )
        for x, y, moves in found
    ]


def test_the_orbits_are_to_one_scale_with_y_up() -> None:
    raw, *_ = lines(picture(), "raw")
    filtered, *_ = lines(picture(), "path")
    assert np.abs(np.hypot(*raw.T) - 840).max() < 2  # 20 um fill the frame
    assert np.abs(np.hypot(*filtered.T) - 420).max() < 2
    assert raw[0].tolist() == [840, 0]
    assert raw[1][1] < 0  # towards +y, which is upwards: the SVG's y points down
    assert filtered[0].tolist() == filtered[-1].tolist()


def test_every_edge_of_the_keyphasor_has_its_dot_and_its_time() -> None:
    html = picture()
    assert html.count('class="keyphasor"') == 5 + 1 + 2 * 5  # raw orbit, 1X orbit, two probes
    assert re.findall(r">(\d+\.\d)</text>", html) == ["0.0", "20.0", "40.0", "60.0", "80.0"]


def test_words_say_what_is_drawn() -> None:
    html = picture()
    assert 'aria-label="Raw orbit of 4 turns at 3000 rpm, top speed, within 20 µm"' in html
    assert 'aria-label="Orbit at 1X at 3000 rpm, top speed, within 10 µm"' in html
    assert "largest raw excursion in µm: a 20, b 20" in html
    assert "frames ±20 µm; what is not 1X, 7.1 µm rms" in html  # 10 / sqrt 2 of either probe
