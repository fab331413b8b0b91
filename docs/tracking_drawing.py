"""The picture of docs/tracking.md: under which weights a row is the mean of a vector, and what comes in from beside."""

import numpy as np
from numpy.typing import NDArray

from docs.svg_plot import COLOURS, FAINT, Figure
from rotorrig.processing.settings import ORDERS
from rotorrig.processing.tracking import angular_resampling, harmonic_least_squares, vold_kalman
from rotorrig.processing.tracking.envelope_splines import SPAN, EnvelopeSplines

TURNS = 8
PER_TURN = 64  # samples
OWN = ORDERS.index(1.0)
FLOOR = 1e-6
HANN, BLACKMAN = (0.5, 0.5), (0.42, 0.5, 0.08)
METHODS = ("resampling", "least-squares", "vold-kalman")
COLOUR = dict(zip(METHODS, COLOURS, strict=False))

Reals = NDArray[np.float64]


def windows() -> Figure:
    """Return the picture."""
    figure = Figure(width=760, height=330)
    figure.key_row(16, 26, [(COLOUR[method], method) for method in METHODS])
    panel = figure.panel(
        (52, 62, 290, 210), x=(-16, 16), y=(-0.05, 0.32), title="weights of a row", xlabel="turns from its middle"
    )
    turns = np.linspace(-16, 16, 641)
    panel.line([-16, 16], [0, 0], colour=FAINT, width=0.8)
    for method, weights in (
        ("vold-kalman", _kalman(turns)),
        ("least-squares", _cosines(turns, HANN)),
        ("resampling", _cosines(turns, BLACKMAN)),
    ):
        panel.line(*panel.straightened(turns, weights, within=0.1), colour=COLOUR[method], width=2)
    panel.note(-15, 0.26, "Blackman's", size=11, colour=COLOUR["resampling"])
    panel.note(-15, 0.24, "Hann's", size=11, colour=COLOUR["least-squares"])
    orders = np.linspace(0.02, 2.5, 621)
    panel = figure.panel(
        (412, 62, 330, 210), x=(0, 2.5), y=(FLOOR, 2), title="what passes into the 1X", xlabel="order", log=True
    )
    panel.line([0.47, 0.47], [FLOOR, 2], colour=FAINT, width=1, dash="4 3")
    panel.note(0.45, 3e-6, "0.47X", size=11, colour=FAINT, anchor="end")
    for method, passed in passing(orders).items():
        panel.line(orders, np.maximum(passed, FLOOR / 10), colour=COLOUR[method], width=1.5)
    return figure


def _cosines(turns: Reals, window: tuple[float, ...]) -> Reals:
    """Return the weights of a window of cosines, of area 1 in turns."""
    weights = sum(a * np.cos(2 * np.pi * k * turns / TURNS) for k, a in enumerate(window))
    return np.where(np.abs(turns) <= TURNS / 2, weights / (window[0] * TURNS), 0.0)


def _kalman(turns: Reals) -> Reals:
    u = 4 * np.abs(turns) / TURNS
    return 2 / TURNS * np.exp(-u) * (np.cos(u) + np.sin(u))


def passing(orders: Reals) -> dict[str, Reals]:
    """Return what each method, tracking the usual orders, makes a 1X of a line of 1 at each of `orders`."""
    turn = np.arange(-8 * TURNS, 8 * TURNS, 1 / PER_TURN) + 0.5 / PER_TURN
    inside = np.abs(turn) < TURNS / 2
    phase = 2 * np.pi * turn[:, None] * orders
    waves = np.hstack([np.cos(phase), np.sin(phase)])
    row = {"orders": ORDERS, "turns": TURNS}
    psi, even = 2 * np.pi * turn[inside], np.ones(int(inside.sum()))
    found = {
        "resampling": angular_resampling.order_vectors(waves[inside], psi, even, **row)[:, OWN],
        "least-squares": harmonic_least_squares.order_vectors(waves[inside], psi, even, **row)[:, OWN],
        "vold-kalman": _by_splines(turn, waves),
    }
    half = len(orders)
    return {name: np.abs(z[:half] + 1j * z[half:]) / 2 for name, z in found.items()}


def _by_splines(turn: Reals, waves: Reals) -> NDArray[np.complex128]:
    """Return the 1X that the Vold-Kalman filter gives of each wave in the middle, (wave,)."""
    knot = TURNS / vold_kalman.KNOTS
    splines = EnvelopeSplines.of(ORDERS, knot=knot, cutoff=vold_kalman.CUTOFF / TURNS)
    cells = round(turn[0] / knot), round(turn[-1] / knot)
    moments = np.zeros((cells[1] - cells[0] + SPAN - 1, waves.shape[1], len(ORDERS), 2))
    splines.add_moments(moments, turn, np.full(len(turn), 1 / PER_TURN), waves, cells=cells)
    return splines.at(splines.solve(moments, first=cells[0]), np.zeros(1), first=cells[0])[0, :, OWN]
