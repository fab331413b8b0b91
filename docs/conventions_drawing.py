"""The drawing of docs/conventions.md: axes, sense of rotation, keyphasor mark, phase lag, the angle of an unbalance."""

import numpy as np
from numpy.typing import NDArray

from docs.svg_plot import COLOURS, FAINT, HAIR, INK, Figure

BLUE, RED, GREEN = COLOURS[0], COLOURS[1], COLOURS[2]
CENTRE, RADIUS, PROBE = (190.0, 215.0), 70.0, 86.0  # px: of the shaft's section; where the probes' tips are
HEAVY = 110.0  # deg, of the heavy spot from the mark
LAG = 60.0  # deg, of the vibration drawn
TURNS = 2.0


def pictures() -> dict[str, Figure]:
    """Return the drawing by its file name."""
    figure = Figure(width=780, height=430)
    _section(figure)
    _waveform(figure)
    return {"conventions.svg": figure}


def _section(figure: Figure) -> None:
    """Draw the shaft seen from its far end towards the coupling, at the moment of the keyphasor edge."""
    x, y = CENTRE
    figure.words(16, 28, "The shaft at theta = 0, seen from its far end: z points at you", size=13)
    figure.circle(x, y, RADIUS, fill="#f2f2f2")
    figure.path([_at(0, 0), _at(0, 150)], arrow=True)
    figure.path([_at(0, 0), _at(90, 150)], arrow=True)
    figure.words(x + 156, y + 5, "+x")
    figure.words(x - 8, y - 157, "+y")
    figure.path([_at(angle, RADIUS + 40) for angle in np.linspace(25, 68, 20)], colour=GREEN, width=2, arrow=True)
    figure.words(*_at(45, RADIUS + 52), "x to y: positive", colour=GREEN)
    _probe(figure, 0, "probe, angle 0 deg")
    _probe(figure, 90, "probe, 90 deg")
    _unbalance(figure)


def _probe(figure: Figure, angle: float, words: str) -> None:
    tip, end = np.array(_at(angle, PROBE)), np.array(_at(angle, PROBE + 26))
    figure.path([tip, end], colour=BLUE, width=7)
    place = (end[0] - 8, end[1] + 22) if angle == 0 else (end[0] - 12, end[1] + 10)
    figure.words(*place, words, colour=BLUE, size=12, anchor="start" if angle == 0 else "end")


def _unbalance(figure: Figure) -> None:
    """Draw mark and heavy spot: at theta = 0 the angle zero of the shaft points to +x."""
    x, y = CENTRE
    figure.path([_at(0, RADIUS - 10), _at(0, RADIUS)], width=6)
    figure.words(x + RADIUS - 8, y + 20, "mark", size=12, anchor="end")
    figure.circle(*_at(HEAVY, RADIUS - 16), 8, fill=RED, stroke=RED)
    figure.path([_at(0, 0), _at(HEAVY, RADIUS - 24)], colour=RED, dash="4 3")
    figure.path([_at(angle, 34) for angle in np.linspace(0, HEAVY - 4, 24)], colour=RED, arrow=True)
    figure.words(x - 104, y + 100, "unbalance: from the mark,", colour=RED, size=12)
    figure.words(x - 104, y + 116, f"in the sense of rotation, here {HEAVY:.0f} deg", colour=RED, size=12)
    figure.words(16, 370, "The mark is the line on the shaft that points to +x as the edge", size=12)
    figure.words(16, 386, "of the pulse comes. With the pickup at +x it is the notch itself,", size=12)
    figure.words(16, 402, "with the pickup at an angle b the notch is b ahead of it.", size=12)


def _waveform(figure: Figure) -> None:
    """Draw what a probe and the keyphasor show over two turns."""
    turns = np.linspace(-0.15, TURNS - 0.15, 400)
    ends = (turns[0], turns[-1])
    probe = figure.panel((470, 50, 272, 150), x=ends, y=(-1.5, 1.5), ylabel="x / amplitude")
    pulse = figure.panel((470, 220, 272, 50), x=ends, y=(-13, 3), xlabel="theta / 360 deg", ylabel="[V]")
    figure.words(470, 40, "What a probe and the keyphasor show", size=13)
    probe.line(ends, [0, 0], colour=HAIR, width=1)
    probe.line(turns, np.cos(2 * np.pi * turns - np.radians(LAG)), colour=BLUE)
    pulse.line(turns, -10.0 * _pulse(turns), colour=INK)
    for start in (0.0, 1.0):
        probe.line([start, start], [-1.5, 1.5], colour=FAINT, width=1, dash="3 3")
        pulse.line([start, start], [-13, 3], colour=FAINT, width=1, dash="3 3")
    lag = LAG / 360
    probe.line([0, lag], [1.2, 1.2], colour=RED)
    probe.line([lag, lag], [1.0, 1.3], colour=RED, width=1)
    probe.note(lag + 0.04, 1.15, f"phase lag {LAG:.0f} deg", colour=RED)
    probe.line([1 + lag, 1 + lag], [0, 1], colour=GREEN)
    probe.note(1 + lag + 0.03, 0.12, "0-peak", colour=GREEN)
    probe.note(0.03, -1.3, "+ is towards the probe", colour=BLUE)
    pulse.note(0.1, -9, "falling edge")
    figure.words(440, 330, "z = 2 mean(x e^(-j theta)), so x = Re(z e^(j theta))", size=12)
    figure.words(440, 350, f"here z = amplitude e^(-j {LAG:.0f} deg); phase lag = -arg z", size=12)
    figure.words(440, 378, "The lag rises by 180 deg through a critical speed.", size=12)
    figure.words(440, 396, "Order n has e^(j n theta); n below 0 whirls backward.", size=12)


def _pulse(turns: NDArray[np.float64]) -> NDArray[np.float64]:
    return ((turns % 1.0) < 0.06).astype(float)


def _at(angle: float, radius: float) -> tuple[float, float]:
    """Return the place in px at an angle [deg] from +x towards +y about the shaft."""
    x, y = CENTRE
    return x + radius * float(np.cos(np.radians(angle))), y - radius * float(np.sin(np.radians(angle)))
