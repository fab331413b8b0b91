"""What benchmarks/tracking.py prints and writes."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.parts.tables import markdown
from benchmarks.parts.tracking.figures import Figures
from rotorrig.processing.response import Method
from rotorrig.processing.settings import USUAL

METHODS: tuple[Method, ...] = ("resampling", "least-squares", "vold-kalman")
NAMES = {method: f"{method} (default)" if method == USUAL.method else method for method in METHODS}
TARGETS = {
    "1X, rms, ideal edges": "0.05 %",
    "1X, phase, rms, ideal edges": "0.05 deg",
    "1X, rms, 50 us of jitter, 1 % of the pulses missing": "0.2 %",
    "95 % intervals that contain the truth": "93 to 97 %",
    "probe seconds per CPU second, one probe": "150",
    "live view, last sample to plotted vector, p99": "0.5 s",
}

INTRODUCTION = """# Order tracking: accuracy and speed

Written by `benchmarks/tracking.py --write` (`make tracking`); do not edit."""

LINE = (
    "The run-up contains a line at 0.47X that is not among the orders tracked, close to half an order from 1X and 0X."
)

METHODS_HEAD = """## The three methods

`rotor track --method` chooses; `--turns` sets the window and with it the noise bandwidth: 1.73 / turns orders with
`resampling`, 1.5 / turns with the others."""

WINDOWS = """![the windows, and what passes beside an order](img/tracking-windows.svg)

*Left: the weights of a row of 8 turns. Right: leakage of a neighbouring line into 1X when 0, 0.5, 1, 2 and 3 are
tracked. No method lets one of these orders leak into another; the two fits also reject most of what is near them.*"""

RUN_UP = """## The run-up

From 600 to 6000 rpm in 30 s at 25.6 kS/s, computed in closed form, independently of the program's tracking, and written
as `run.mcap`: 50 um of 1X, 10 um of 2X, 5 um of 0.47X (all 0-peak), 8 um of runout (orders 1 to 5), 0.5 um rms of
white noise, a 24-bit converter. Rows of 8 turns; orders 0, 0.5, 1, 2 and 3, so 0.47X is not among them.
*Ideal edges*: the keyphasor's flank, 10 degrees wide, passes the threshold at theta = 0. *Jitter*: each pulse early or
late by 50 us rms, 1.8 degrees at full speed, and 1 % of the pulses missing. An error is |z - truth| / |truth| over all
usable rows and four probes; phase errors are in degrees of the order's own angle."""

RESONANCE = """At the resonance (2400 rpm, damping ratio 0.02, 100 um at its peak, no noise, no 0.47X) the truth is
the mean of the vector under the window that the file names, by quadrature. *Smear* is the difference between that mean
and the vector at the middle of the row: the error of a model that ignores the window."""

SOURCES = """Noise of 0.5 um rms in 8 turns makes 0.04 to 0.05 % of 50 um with any method. Of 0.47X, 0.08 % of its
amplitude passes the window of `resampling` (Hann's, with 7 % less noise, would pass 0.30 %); the other methods have
equations for 0.5X, which absorb most of it. `least-squares` and `vold-kalman` also track 0.47X itself, if it is
among the orders. `vold-kalman` is exact at 2X and 3X only as far as the 4X and 5X of the runout are small, which are in
none of its equations."""

INTERVALS = """## 95 % intervals

Over {draws} recordings of two probes each, the share of intervals that contain the truth, real and imaginary parts
together; lowest and highest are of any single order and part. 0X has a real part only. The intervals account for noise
and jitter, not for the leakage of an untracked line, such as that of 0.47X with `resampling`, which is slight."""

SPEED = """## Speed

Seconds of one probe's samples that `track` processes per second of CPU, one thread, all included: keyphasor, vectors,
covariance and quality checks. The best of {rounds}, since other work on the machine costs up to half."""

OTHERS = """## Compared with others

The same four probes, orders 1, 2 and 3, rows of 8 turns. `rota-order` 0.3.0 (GPL-3, used only here and in the tests)
gives waveforms and envelopes at every sample, ours vectors per row with their uncertainty and mask. Its windows
are Hann's of 8 turns, one after another; its angle is the integral of a speed, referred here to its own pulses so
that phases can be compared. The bandwidth of its Vold-Kalman filter is in Hz, set here to ours at the middle of the
run-up: at 600 rpm it is half an order wide. *plain scipy* is a cubic spline through the edges, one through the
waveform, and `scipy.signal.stft`. Errors are of 1X; two rows at either end are left out, as rota-order advises."""


def page(figures: Figures, *, draws: int, rounds: int) -> str:
    """Return docs/tracking.md."""
    return "\n\n".join(
        (
            INTRODUCTION,
            headline(figures),
            LINE,
            METHODS_HEAD,
            methods(),
            WINDOWS,
            RUN_UP,
            "## 1X",
            first(figures),
            RESONANCE,
            "## Sources of the error",
            parts(figures),
            SOURCES,
            INTERVALS.format(draws=draws),
            coverage(figures),
            SPEED.format(rounds=rounds),
            speed(figures),
            memory(figures),
            "For recordings of four probes; including numba, scipy and the rest of the program.",
            OTHERS,
            peers(figures),
            "## Live",
            f"{live(figures)}\n",
        )
    )


def headline(figures: Figures) -> str:
    """Return the table of targets and what each method attains."""
    columns = [_headline(figures.of(method)) for method in METHODS]
    rows = [(what, want, *got) for (what, want), *got in zip(TARGETS.items(), *columns, strict=True)]
    return markdown(("", "wanted", *NAMES.values()), rows)


def _headline(found: dict[str, Any]) -> list[str]:
    return [
        f"{found['rms_percent']:.3f} %",
        f"{found['phase_deg_rms']:.3f} deg",
        f"{found['rms_percent_jitter']:.2f} %",
        f"{100 * found['coverage95']:.1f} %",
        f"{found['realtime_factor']:.0f}",
        "not measured" if found["live_latency_s"] is None else f"{found['live_latency_s']:.2f} s",
    ]


def methods() -> str:
    """Return the table of the methods' properties."""
    rows = [
        ("", *METHODS),
        ("---", "---", "---", "---"),
        (
            "what it is",
            "a DFT over the shaft angle, of all samples at their own angles",
            "a fit of all orders tracked and the integer ones up to one above, with their slopes",
            "smooth envelopes of all orders at once, over the whole run",
        ),
        (
            "window of a row",
            "Blackman's, over `turns`",
            "Hann's, over `turns`",
            "e^(-u) (cos u + sin u), u = 4 turns away / `turns`",
        ),
        ("its reach", "`turns`", "`turns`", "3.93 `turns`; rows that lack it at an end are masked"),
        ("a parabola in the amplitude", "is flattened", "is flattened", "is kept"),
        ("least spacing of orders", "3 / turns, `turns` times each an integer", "1 / turns", "1 / turns"),
    ]
    return "\n".join(f"| {' | '.join(row)} |" for row in rows)


def first(figures: Figures) -> str:
    """Return the table of the errors of 1X."""
    rows = []
    for case, title in (("ideal", "ideal edges"), ("jitter", "jitter"), ("resonance", "resonance, ideal edges")):
        for method, name in NAMES.items():
            score = figures.first[case, method]
            smear = f"{figures.smear[method].vector_percent:.3f}" if case == "resonance" else ""
            rows.append(
                (
                    f"{title}: {name}",
                    f"{score.vector_percent:.3f}",
                    f"{score.amplitude_percent:.3f}",
                    f"{score.phase_deg:.3f}",
                    f"{score.worst_percent:.2f}",
                    f"{100 * score.usable:.1f}",
                    smear,
                )
            )
    head = ("1X", "vector, % rms", "amplitude, % rms", "phase, deg rms", "worst, %", "usable, %", "smear, % rms")
    return markdown(head, rows)


def parts(figures: Figures) -> str:
    """Return the table of the errors of each source by itself."""
    head = ("vector error, % rms", "1X", "1X, noise only", "1X, 0.47X only", "1X, neither", "2X")
    cases = ("ideal", "noise alone", "0.47X alone", "neither")
    rows = [
        (
            name,
            *(f"{figures.first[case, method].vector_percent:.4f}" for case in cases),
            f"{figures.second['ideal', method].vector_percent:.4f}",
        )
        for method, name in NAMES.items()
    ]
    return markdown(head, rows)


def coverage(figures: Figures) -> str:
    """Return the table of the intervals."""
    rows = []
    for case, title in (("ideal", "ideal edges"), ("jitter", "jitter")):
        for method, name in NAMES.items():
            found = figures.coverage[case, method]
            orders = dict.fromkeys(order for order, _ in found.asked)
            low, high = found.extremes()
            shares = [*(found.share(order) for order in orders), found.share(), low, high]
            rows.append((f"{title}: {name}", *(f"{100 * share:.1f}" for share in shares)))
    return markdown(("% of the intervals", *(f"{order:g}X" for order in orders), "all", "lowest", "highest"), rows)


def speed(figures: Figures) -> str:
    """Return the table of the real-time factors."""
    counts = dict.fromkeys(probes for _, probes in figures.realtime)
    head = ("times real time, per probe", *(f"{probes} probe{'s' * (probes > 1)}" for probes in counts))
    rows = [(name, *(f"{figures.realtime[method, probes]:.0f}" for probes in counts)) for method, name in NAMES.items()]
    return markdown(head, rows)


def memory(figures: Figures) -> str:
    """Return the table of the memory."""
    lengths = dict.fromkeys(seconds for _, seconds in figures.memory)
    head = ("memory of `rotor track` at most, MB", *(f"{seconds:.0f} s" for seconds in lengths))
    rows = [
        (name, *(f"{figures.memory[method, seconds] / 1e6:.0f}" for seconds in lengths))
        for method, name in NAMES.items()
    ]
    return markdown(head, rows)


def peers(figures: Figures) -> str:
    """Return the comparison with other programs."""
    rows = [
        (
            name,
            f"{figures.seconds[name]:.2f}",
            f"{figures.seconds[name] / figures.seconds['ours']:.1f}",
            f"{figures.peers[name].vector_percent:.3f}",
            f"{figures.peers[name].phase_deg:.3f}",
            f"{figures.peers[name + ', jitter'].vector_percent:.2f}",
        )
        for name in figures.seconds
    ]
    head = (
        "30 s of four probes",
        "CPU, s",
        "times ours",
        "vector, % rms",
        "phase, deg rms",
        "vector with jitter, % rms",
    )
    return markdown(head, rows)


def live(figures: Figures) -> str:
    """Return the section on the live view."""
    if figures.latency is None or not len(figures.latency):
        return "Not measured in this run."
    ms = 1e3 * figures.latency
    delays = ", ".join(f"{value:.0f} ms {name}" for name, value in _spread(ms).items())
    return f"""Eight channels at 50 kS/s in blocks of 20 ms, in real time, through the view's own process into a viewer.
From handing over the block with a row's last sample to the arrival of the last byte of its picture at the viewer,
{len(ms)} rows of 8 turns:
{delays}. That picture is
the moving dot in the Bode and polar plots; their curves are updated once a second."""


def _spread(ms: NDArray[np.float64]) -> dict[str, float]:
    return {
        "in the median": np.median(ms),
        "p90": np.percentile(ms, 90),
        "p99": np.percentile(ms, 99),
        "at most": ms.max(),
    }
