"""What is wrong with a row: a mask per probe, and the reason in words ("1x: clipped", "missed pulse")."""

import numpy as np
from numpy.typing import NDArray

from rotorrig.processing.orders import Rows
from rotorrig.processing.runs import Span
from rotorrig.processing.tacho import ShaftAngle
from rotorrig.processing.waveform import Stretch, Waveforms
from rotorrig.rig.description import Probe

SAMPLES_PER_TURN = 20  # fewer leave the sum over a turn, and order 2 and above, inexact
BACKWARDS = 0.01  # of the speed: a run that turns back by more is no run-up or coast-down there

Reasons = tuple[tuple[str, ...], ...]


def assess(
    waveforms: Waveforms, shaft: ShaftAngle, rows: Rows, *, spans: tuple[Span, ...], probes: tuple[Probe, ...]
) -> tuple[NDArray[np.bool_], Reasons]:
    """Return usable (row, probe) and the reasons (row,) why not."""
    turning = _against_the_run(rows, spans)
    usable = np.ones((len(rows.t), len(probes)), dtype=bool)
    reasons: list[tuple[str, ...]] = []
    for i in range(len(rows.t)):
        whole = _flaws(shaft, int(rows.first_turn[i]), rows.turns)
        if turning[i]:
            whole.append(turning[i])
        stretch = waveforms.between(rows.begin[i], rows.end[i])
        single: list[str] = []
        if stretch is None:
            whole.append("gap in the samples")
        else:
            if len(stretch.t) < SAMPLES_PER_TURN * rows.turns:
                whole.append(f"{len(stretch.t) / rows.turns:.0f} samples per turn, want {SAMPLES_PER_TURN}")
            for p, probe in enumerate(probes):
                if fault := probe_fault(stretch, p, probe=probe, full_scale=waveforms.full_scale):
                    usable[i, p] = False
                    single.append(f"{probe.name}: {fault}")
        if whole:
            usable[i] = False
        reasons.append((*dict.fromkeys(whole), *single))
    return usable, tuple(reasons)


def probe_fault(stretch: Stretch, column: int, *, probe: Probe, full_scale: int) -> str:
    """Return what is wrong with one probe's samples, empty if nothing."""
    counts, x = stretch.counts[:, column], stretch.x[:, column]
    if counts.max() >= full_scale - 1 or counts.min() <= -full_scale:
        return "clipped"
    low, high = sorted((volts - probe.gap_voltage) / probe.sensitivity for volts in probe.linear_range)
    if x.min() < low or x.max() > high:
        return "gap out of range"
    return ""


def _flaws(shaft: ShaftAngle, first_turn: int, turns: int) -> list[str]:
    """Return the reasons of the flawed turns that a row overlaps."""
    return [f.reason for f in shaft.flaws if f.first_turn < first_turn + turns and f.last_turn > first_turn]


def _against_the_run(rows: Rows, spans: tuple[Span, ...]) -> list[str]:
    """Return, per row, in words, that its speed goes against its run's direction; empty where it does not."""
    words = [""] * len(rows.t)
    for index, span in enumerate(spans):
        mine = np.flatnonzero(rows.run == index)
        direction = span.run.direction
        if direction == 0 or len(mine) == 0:
            continue
        so_far = np.maximum.accumulate(direction * rows.omega[mine])
        behind = so_far - direction * rows.omega[mine] > BACKWARDS * rows.omega[mine]
        for i in mine[behind]:
            words[i] = "speed reversal"
    return words
