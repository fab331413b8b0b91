"""`python -m docs.make_chapter`: pictures of docs/chapter.md, Figs. 4, 8, 9 and 12 to 14 from our own runs.

A minute. Fig. 4 from searches of a function made for it, Fig. 8 from those that benchmarks/chea_table7.py counts, Fig.
9 from the first draw of Table 8, Figs. 12 to 14 from the first simulated rig of Table 10. Not made again by the tests,
for the reason in make_chea_table7.py.
"""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.signal import periodogram

from benchmarks.parts.identification import table8, table10
from benchmarks.parts.identification.seed_stages import watch
from benchmarks.parts.identification.table7 import OBJECTIVES, oracle_response, steady
from docs.chapter_narrow import narrow_minimum
from docs.make_chea_table7 import DRAWN
from docs.origin import origin
from docs.svg_plot import COLOURS, FAINT, Figure
from rotorrig.identify.base_model.global_search import search_amplitudes
from rotorrig.identify.measurement import measure
from rotorrig.processing import Tracking, track
from rotorrig.processing.waveform import Waveforms
from rotorrig.rig.config import RPM, load

Array = NDArray[np.float64]

COMMAND = "python -m docs.make_chapter"
ROOT = Path(__file__).parents[1]
IMAGES = Path(__file__).parent / "img"
MICROMETRE = 1e-6
INSTANT = 1350 / RPM
STRETCH, SHOWN = 4.0, 0.5  # s: in the spectrum, and drawn
HIGHEST = 80.0  # Hz
CRITICAL = 2230 / RPM  # the first of configs/rk4.toml
STEPS = {"genetic": COLOURS[2], "local": COLOURS[0], "far": COLOURS[4]}
WORDS = {"genetic": "genetic algorithm", "local": "local searches", "far": "random search"}


def main() -> None:
    """Draw all of them."""
    lalanne, rk4 = (load(ROOT / name).hash for name in ("benchmarks/lalanne.toml", "configs/rk4.toml"))
    narrow_minimum().save(IMAGES / "chapter-fig4.svg", origin=origin(COMMAND))
    history().save(IMAGES / "chapter-fig8.svg", origin=origin(COMMAND, lalanne))
    noisy().save(IMAGES / "chapter-fig9.svg", origin=origin(COMMAND, lalanne))
    instant().save(IMAGES / "chapter-fig13.svg", origin=origin(COMMAND, rk4))
    measured().save(IMAGES / "chapter-fig14.svg", origin=origin(COMMAND, rk4))


def history() -> Figure:
    """Fig. 8: the lowest value over the calls, coloured by the step that made them."""
    figure = Figure(width=790, height=300)
    met: set[str] = set()
    for column, objective in enumerate(OBJECTIVES):
        seen = watch(objective, DRAWN[objective])
        lowest = np.minimum.accumulate(seen.values)
        ends = (10 ** np.floor(np.log10(lowest.min())), 10 ** np.ceil(np.log10(lowest[:1000].max()) + 0.1))
        panel = figure.panel(
            (60 + 250 * column, 40, 180, 180), x=(0, len(lowest) / 1000), y=ends, log=True, title=objective,
            xlabel="thousand calls", ylabel="" if column else "lowest value",
        )  # fmt: skip
        met |= {kind for kind, _ in seen.steps}
        began = 0
        for kind, end in merged(seen.steps):
            if end > began:
                x, y = panel.straightened(np.arange(began, end) / 1000, lowest[began:end], within=0.3)
                panel.line(x, y, colour=STEPS[kind], width=2)
            began = end
    figure.key_row(60, 284, [(STEPS[kind], WORDS[kind]) for kind in STEPS if kind in met])
    return figure


def merged(steps: list[tuple[str, int]]) -> list[tuple[str, int]]:
    """Return the last of every kind in a row.

    >>> merged([("genetic", 2), ("genetic", 4), ("local", 5)])
    [('genetic', 4), ('local', 5)]
    """
    return [step for step, after in zip(steps, [*steps[1:], ("", 0)], strict=True) if step[0] != after[0]]


def noisy() -> Figure:
    """Fig. 9: amplitudes with 10 % noise, without, and identified by f2."""
    figure = Figure(width=790, height=330)
    amplitudes = table8.noisy(0)
    optima, *_ = search_amplitudes(amplitudes, objective="f2", rng=np.random.default_rng(0))
    theta = np.array(optima[0].theta)
    exact, rpm = np.abs(oracle_response()), steady().receptance.omega * RPM
    identified = np.abs(steady().receptance.response(*theta))
    drawn = exact * table8.factors(0)
    for column, (probe, axis) in enumerate([(0, "horizontal"), (1, "vertical")]):
        panel = figure.panel(
            (70 + 370 * column, 40, 320, 220), x=(0, 15_000), y=_decades(drawn), log=True, title=f"node 2, {axis}",
            xlabel="speed [rpm]", ylabel="" if column else "amplitude [um]",
        )  # fmt: skip
        panel.points(np.column_stack([rpm, drawn[:, probe] / MICROMETRE]), colour=COLOURS[1], size=4)
        panel.line(rpm, exact[:, probe] / MICROMETRE, colour=FAINT, width=3)
        panel.line(rpm, identified[:, probe] / MICROMETRE, colour=COLOURS[0], width=1.2)
    figure.key_row(70, 314, [(COLOURS[1], "10 % noise"), (FAINT, "without noise"), (COLOURS[0], "identified by f2")])
    return figure


def _decades(amplitude: Array) -> tuple[float, float]:
    """Return the powers of ten [um] that amplitudes [m] lie between."""
    logs = np.log10(amplitude / MICROMETRE)
    return float(10 ** np.floor(logs.min())), float(10 ** np.ceil(logs.max()))


def measured() -> Figure:
    """Figs. 12 and 14: 1X amplitudes of a simulated RK4 below its critical speed, and identified by f3."""
    figure = Figure(width=790, height=330)
    response = table10.simulated(table10.FIRST_SEED)
    vectors = measure(response)
    amplitudes = table10.chapter_amplitudes(response, vectors, slow_roll=True)
    optima, *_ = search_amplitudes(amplitudes, objective="f3", rng=np.random.default_rng(0))
    z = amplitudes.steady.receptance.response(*optima[0].theta)
    rpm = response.omega[vectors.rows] * RPM
    shown = [np.abs(one[:-1] - one[-1]) / MICROMETRE for one in (vectors.z, z)]
    for column, probe in enumerate(response.probes):
        panel = figure.panel(
            (70 + 370 * column, 40, 320, 220), x=(400, 2200), y=(0.0, float(np.ceil(shown[0].max() / 20) * 20)),
            title=f"probe {probe}", xlabel="speed [rpm]", ylabel="" if column else "1X less slow roll [um]",
        )  # fmt: skip
        panel.points(np.column_stack([rpm, shown[0][:, column]]), colour=COLOURS[1], size=4)
        panel.line(rpm, shown[1][:, column], colour=COLOURS[0], width=1.5)
    figure.key_row(70, 314, [(COLOURS[1], "run-up of a simulated RK4"), (COLOURS[0], "identified by f3")])
    return figure


def instant() -> Figure:
    """Fig. 13: what the vertical probe of that RK4 reads about 1350 rpm, and its spectrum."""
    figure = Figure(width=790, height=300)
    recording = table10.recorded(table10.FIRST_SEED)
    response = track(recording, Tracking(orders=(1.0,)))
    vertical = response.probes.index("1y")
    row = int(np.abs(response.omega - INSTANT).argmin())
    stretch = Waveforms(recording).between(response.t[row] - STRETCH / 2, response.t[row] + STRETCH / 2)
    assert stretch is not None
    x = stretch.x[:, vertical] - stretch.x[:, vertical].mean()
    frequency, power = periodogram(x, recording.daq.sample_rate, window="hann", scaling="spectrum")
    amplitude = np.sqrt(2 * power)
    shown, drawn = np.abs(stretch.t - response.t[row]) < SHOWN / 2, frequency < HIGHEST
    largest = float(np.ceil(np.abs(x[shown]).max() / MICROMETRE / 5) * 5)
    panel = figure.panel(
        (70, 40, 310, 220), x=(-SHOWN / 2, SHOWN / 2), y=(-largest, largest), title="probe 1y at 1350 rpm",
        xlabel="time [s]", ylabel="displacement [um]",
    )  # fmt: skip
    t = stretch.t[shown] - response.t[row]
    panel.line(*panel.straightened(t, x[shown] / MICROMETRE, within=0.3), colour=COLOURS[0], width=1)
    panel = figure.panel(
        (470, 40, 290, 220), x=(0, HIGHEST), y=(1e-2, 1e2), log=True, title="its spectrum, 4 s",
        xlabel="frequency [Hz]", ylabel="amplitude [um 0-peak]",
    )  # fmt: skip
    line = amplitude[drawn] / MICROMETRE
    panel.line(*panel.straightened(frequency[drawn], line, within=0.3), colour=COLOURS[0], width=1)
    turning, natural = response.omega[row] / (2 * np.pi), CRITICAL / (2 * np.pi)
    for hz, words in ((turning, "1X"), (natural, "natural"), (2 * turning, "2X"), (3 * turning, "3X")):
        near = np.abs(frequency - hz) < 1
        panel.note(hz, 1.5 * amplitude[near].max() / MICROMETRE, words, anchor="middle")
    return figure


if __name__ == "__main__":
    main()
