"""The picture of an effect's signature: Bode plot, forward and backward whirl, and what else it brings."""

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from docs.effect_response import HIGHEST, LOWEST, ORDERS, Vectors
from docs.svg_plot import COLOURS, FAINT, Figure, Panel
from rotorrig.rig.config import UM

WITHOUT, WITH, BACKWARD, SECOND, THIRD = FAINT, COLOURS[0], COLOURS[1], COLOURS[2], COLOURS[3]
SHOWN = 0.02  # um: less of an order, or of a difference between up and down, is not drawn
LEAST = 0.1  # um, the lower end of a logarithmic axis
NOUGHT = 1e-6  # um: stands for none on a logarithmic axis
SPEEDS = (LOWEST, HIGHEST)
STRAIGHT = 0.2  # px: a point as near as that to the line through its neighbours is left out
DASHED = "5 3"
WIDEST = 100  # characters of a line of the heading


@dataclass(frozen=True, slots=True, kw_only=True)
class Signature:
    """What is drawn of one effect: the vectors of a rotor without it and with it."""

    name: str
    words: str  # the cause with its size
    without: Vectors
    with_it: Vectors


def drawn(signature: Signature) -> Figure:
    """Return the picture: 1X of the first probe on the left, whirl and higher orders of its plane on the right.

    The first two probes are a plane's x and y. Dashed: the coast-down, where it differs.
    """
    figure = Figure(width=760, height=474)
    for line, text in enumerate(textwrap.wrap(f"{signature.name}: {signature.words}", WIDEST)):
        figure.words(16, 24 + 17 * line, text, size=13)
    figure.key_row(16, 66, [(WITHOUT, "without it"), (WITH, "with it"), (BACKWARD, "backward whirl, with it")])
    figure.words(744, 66, "dashed: coast-down, where it differs", size=12, anchor="end", colour=FAINT)
    _amplitude(figure, signature)
    _phase(figure, signature)
    _whirl(figure, signature)
    _brought(figure, signature)
    return figure


def _amplitude(figure: Figure, signature: Signature) -> None:
    curves = [np.abs(run[1][:, 0]) * UM for run in _runs(signature)]
    panel = _panel(figure, (62, 96, 298, 150), y=_decades(curves), ylabel="1X at 1x [um 0-peak]", log=True)
    _lines(panel, signature.with_it.rpm, curves, (WITHOUT, WITH))


def _phase(figure: Figure, signature: Signature) -> None:
    curves = [_lag(run[1][:, 0]) for run in _runs(signature)]
    turns = [360 * round(float(np.median(c - curves[0])) / 360) for c in curves]
    curves = [c - turn for c, turn in zip(curves, turns, strict=True)]
    low, high = min(c.min() for c in curves), max(c.max() for c in curves)
    ends = (min(-10.0, low - 10), max(190.0, high + 10))
    panel = _panel(figure, (62, 304, 298, 120), y=ends, ylabel="phase lag [deg]", xlabel="speed [rpm]")
    _lines(panel, signature.with_it.rpm, curves, (WITHOUT, WITH))


def _whirl(figure: Figure, signature: Signature) -> None:
    runs = _runs(signature)
    forward = [np.abs(run[1][:, 0] + 1j * run[1][:, 1]) / 2 * UM for run in runs]
    backward = [np.abs(run[1][:, 0] - 1j * run[1][:, 1]) / 2 * UM for run in runs]
    every = [*forward, *backward]
    title = "forward and backward whirl at 1X, plane 1"
    panel = _panel(figure, (440, 96, 298, 150), y=_decades(every), ylabel="radius [um]", log=True, title=title)
    panel.line(signature.without.rpm, np.maximum(backward[0], NOUGHT), colour=WITHOUT, width=1, dash="1 3")
    _lines(panel, signature.with_it.rpm, backward[1:], (BACKWARD,))
    _lines(panel, signature.with_it.rpm, forward, (WITHOUT, WITH))


def _brought(figure: Figure, signature: Signature) -> None:
    """Draw the change of the vector at every order that changes."""
    at = (440, 304, 298, 120)
    colours = dict(zip(ORDERS, (WITH, SECOND, THIRD), strict=True))
    nothing, *runs = _runs(signature)
    changes = {n: [np.abs(run[n][:, 0] - nothing[n][:, 0]) * UM for run in runs] for n in ORDERS}
    changes = {n: both for n, both in changes.items() if max(c.max() for c in both) > SHOWN}
    y = _decades([c for both in changes.values() for c in both], least=0.01)
    panel = _panel(figure, at, y=y, ylabel="|change| [um]", log=True, xlabel="speed [rpm]")
    for n, both in changes.items():
        _lines(panel, signature.with_it.rpm, both, (colours[n],))
    figure.words(440, 296, "what it changes at 1x:", size=13)
    figure.key_row(600, 296, [(colours[n], f"{n}X") for n in changes])


def _runs(signature: Signature) -> list[dict[int, NDArray[np.complex128]]]:
    """Return the run-up without the effect and with it; and the coast-down, where that is another."""
    up, down = signature.with_it.up, signature.with_it.down
    other = max(float(np.abs(down[n] - up[n]).max()) for n in ORDERS) * UM > SHOWN
    return [signature.without.up, up, *([down] if other else [])]


def _lag(z: NDArray[np.complex128]) -> NDArray[np.float64]:
    """Return the phase lag [deg] without jumps, between -90 and 270 at the first row."""
    lag = np.degrees(np.unwrap(-np.angle(z)))
    return lag - 360 * np.floor((lag[0] + 90) / 360)


def _decades(curves: Sequence[NDArray[np.float64]], least: float = LEAST) -> tuple[float, float]:
    """Return the decades that hold the curves, none below `least`."""
    low = max(min(float(c.min()) for c in curves), least)
    high = max(float(c.max()) for c in curves)
    return float(10 ** np.floor(np.log10(low))), float(10 ** np.ceil(np.log10(max(high, 2 * least))))


def _panel(
    figure: Figure,
    at: tuple[float, float, float, float],
    *,
    y: tuple[float, float],
    ylabel: str,
    title: str = "",
    xlabel: str = "",
    log: bool = False,
) -> Panel:
    return figure.panel(at, x=SPEEDS, y=y, title=title, xlabel=xlabel, ylabel=ylabel, log=log)


def _lines(
    panel: Panel, rpm: NDArray[np.float64], curves: Sequence[NDArray[np.float64]], colours: Sequence[str]
) -> None:
    """Draw curves in their colours; one more than there are colours is the coast-down of the last."""
    for i, curve in enumerate(curves):
        colour, dash = (colours[i], "none") if i < len(colours) else (colours[-1], DASHED)
        x, y = panel.straightened(rpm, np.maximum(curve, NOUGHT) if panel.log else curve, within=STRAIGHT)
        panel.line(x, y, colour=colour, width=1.2 if colour == WITHOUT else 1.6, dash=dash)
