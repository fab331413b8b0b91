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
    "1X, rms, 50 us of jitter, 1 % of the pulses missed": "0.2 %",
    "95 % intervals that hold the truth": "93 to 97 %",
    "probe seconds per CPU second, one probe": "150",
    "live view, last sample to plotted vector, p99": "0.5 s",
}


def page(figures: Figures, *, draws: int, rounds: int) -> str:
    """Return docs/tracking.md."""
    return f"""# How exact and how quick the tracking is

Written by `benchmarks/tracking.py --write` (`make tracking`); do not edit.

{headline(figures)}

The run-up has a line at 0.47X that nobody asked for, half an order from the 1X and from the 0X.

## Three methods

`rotor track --method` chooses; `--turns` is how much noise passes: as much as through 1.73 / turns orders with
`resampling`, through 1.5 / turns with the others.

{methods()}

![the windows, and what passes beside an order](img/tracking-windows.svg)

*Left: the weights of a row of 8 turns. Right: how much of a line beside it each method takes for 1X when it tracks 0,
0.5, 1, 2 and 3. None of them lets another of these through; the fits little of what is near them either.*

## The run-up

From 600 to 6000 rpm in 30 s at 25.6 kS/s, made in closed form without a line of the program's own tracking and written
as `run.mcap`: 50 um of 1X, 10 um of 2X, 5 um of 0.47X (all 0-peak), 8 um of run-out (orders 1 to 5), 0.5 um rms of
white noise, a 24-bit converter. Rows of 8 turns, the orders 0, 0.5, 1, 2 and 3, so 0.47X is one that nobody asked for.
*Ideal edges*: the keyphasor's flank, 10 degrees wide, passes the threshold at theta = 0. *Jitter*: each pulse early or
late by 50 us rms, 1.8 degrees at full speed, and 1 % of them missing. An error is |z - truth| / |truth| over all usable
rows and four probes; phase errors are in degrees of the order's own angle.

## The 1X

{first(figures)}

At the resonance (2400 rpm, damping ratio 0.02, 100 um at its peak, without noise and 0.47X) the truth is the mean of
the vector under the window that the record names, by quadrature; *smear* is how far that mean is from the vector in the
row's middle, which a model that leaves the window out has as an error.

## What the error is made of

{parts(figures)}

Noise of 0.5 um rms in 8 turns is 0.04 to 0.05 % of 50 um however it is tracked. 0.47X passes the window of `resampling`
by 0.08 % of its own amplitude (Hann's, of less noise by 7 %, would pass 0.30 %); the other methods have equations for
0.5X, which take most of 0.47X with them. Asked for by itself, 0.47X comes out too, by `least-squares` and
`vold-kalman`. The last is only as exact in the 2X and 3X as the 4X and 5X of the run-out are small: they are in none of
its equations.

## 95 % intervals

Over {draws} recordings of two probes each, the share of intervals that hold the truth; both parts together, with the
lowest and highest of any order and part. The 0X has but a real part. An interval knows of the noise and of the jitter,
not of a line that leaks, as 0.47X does a little by `resampling`.

{coverage(figures)}

## Speed

Seconds of one probe's samples that `track` gets through in a second of CPU, one thread, the whole of it: keyphasor,
vectors, covariance and quality. The best of {rounds}, since other work on the machine costs up to half.

{speed(figures)}

{memory(figures)}

Of recordings of four probes; numba, scipy and the rest of the program are in it.

## Beside others

The same four probes and the orders 1, 2 and 3, rows of 8 turns. `rota-order` 0.3.0 (GPL-3, used here and in the tests
alone) gives waveforms and envelopes at every sample, ours vectors per row with their uncertainty and mask. Its windows
are Hann's of 8 turns, one after another; its angle is the integral of a speed, brought back here to its own pulses so
that phases can be compared. The bandwidth of its Vold-Kalman filter is in Hz, here ours at the middle of the run-up: at
600 rpm it is half an order wide. *plain scipy* is a cubic spline through the edges, one through the waveform, and
`scipy.signal.stft`. Errors are of the 1X; two rows at either end are left out, as rota-order advises.

{peers(figures)}

## Live

{live(figures)}
"""


def headline(figures: Figures) -> str:
    """Return what was wanted, and what each method does."""
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
    """Return the table of what the methods are."""
    rows = [
        ("", *METHODS),
        ("---", "---", "---", "---"),
        (
            "what it is",
            "a DFT over the shaft angle, of all samples where they are",
            "a fit of all orders asked for and the whole ones to one above, their slopes with them",
            "smooth envelopes of all orders at once, over the whole run",
        ),
        (
            "a row is the mean under",
            "Blackman's window of `turns`",
            "Hann's of `turns`",
            "e^(-u) (cos u + sin u), u = 4 turns away / `turns`",
        ),
        ("which reaches over", "`turns`", "`turns`", "3.93 `turns`; what lacks that at an end is masked"),
        ("a parabola in the amplitude", "is flattened", "is flattened", "passes as it is"),
        ("orders may be apart", "3 / turns, `turns` times each whole", "1 / turns", "1 / turns"),
    ]
    return "\n".join(f"| {' | '.join(row)} |" for row in rows)


def first(figures: Figures) -> str:
    """Return the table of the 1X's errors."""
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
    """Return the table of the errors of each part by itself."""
    head = ("vector error, % rms", "1X", "1X, noise alone", "1X, 0.47X alone", "1X, neither", "2X")
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
    """Return the table beside others."""
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
    found = ", ".join(f"{value:.0f} ms {name}" for name, value in _spread(ms).items())
    return f"""Eight channels at 50 kS/s in blocks of 20 ms, in real time, through the view's own process into a viewer.
From the moment the block with a row's last sample is handed over to the moment the last byte of the picture with its
vector has arrived at the viewer, {len(ms)} rows of 8 turns:
{found}. That picture is
the moving dot in the Bode and polar plots; their curves take it up once a second."""


def _spread(ms: NDArray[np.float64]) -> dict[str, float]:
    return {
        "in the median": np.median(ms),
        "p90": np.percentile(ms, 90),
        "p99": np.percentile(ms, 99),
        "at most": ms.max(),
    }
