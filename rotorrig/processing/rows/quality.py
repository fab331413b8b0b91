"""Data quality of rows: a mask per probe, with the reason in words ("1x: clipped", "missed pulse").

A reason takes a row, or one probe of it, out of use. A remark is only worth knowing of a usable row; others come from
`noise.mains_lines`. NaN and infinite samples never come this far: counts are whole numbers, and the importers refuse a
file that holds others, with the place.
"""

import numpy as np
from numpy.typing import NDArray

from rotorrig.processing.rows.rows import Rows
from rotorrig.processing.rows.runs import Span
from rotorrig.processing.shaft_angle import TURN, Flaw, ShaftAngle
from rotorrig.processing.waveform import Stretch, Waveforms
from rotorrig.rig.config import Probe

SAMPLES_PER_TURN = 20  # fewer leave the sum over a turn, and order 2 and above, inexact
BACKWARDS = 0.01  # of the speed: a run that turns back by more is no run-up or coast-down there
ALIAS_FREE = 1 / 2.56  # of the sample rate: what an anti-alias filter lets through, by the custom of the trade
LONGEST_TOP = 3  # samples in a row at the highest or lowest code; more may be a flat top
FLAT_SHARE = 0.6  # of the samples within TOP_STEPS of the extreme that are on it; a cosine leaves 0.3 = 1 / sqrt(11)
TOP_STEPS = 10  # steps of the ADC
FEWEST_NEAR = 16  # samples within these: where vibration grows from turn to turn, one crest alone has so few, by chance
MOVING = 50  # steps of the ADC from lowest to highest code, below which a top is a matter of rounding

Reasons = tuple[tuple[str, ...], ...]


def assess(
    waveforms: Waveforms, shaft: ShaftAngle, rows: Rows, *, spans: tuple[Span, ...], probes: tuple[Probe, ...]
) -> tuple[NDArray[np.bool_], Reasons]:
    """Return the mask usable (row, probe) and the reasons (row,) why not."""
    turning = _speed_reversals(rows, spans)
    usable = np.ones((len(rows.t), len(probes)), dtype=bool)
    reasons: list[tuple[str, ...]] = []
    for i in range(len(rows.t)):
        whole = _overlapping(shaft.flaws, float(rows.first_turn[i]), rows.turns)
        if turning[i]:
            whole.append(turning[i])
        stretch = waveforms.between(rows.begin[i], rows.end[i])
        single: list[str] = []
        if stretch is None:
            whole.append("gap in the samples")
        else:
            if len(stretch.t) < SAMPLES_PER_TURN * rows.turns:
                whole.append(f"{len(stretch.t) / rows.turns:.0f} samples per turn, want {SAMPLES_PER_TURN}")
            faults = probe_faults(stretch, probes=probes, full_scale=waveforms.full_scale)
            usable[i] = [not fault for fault in faults]
            single = [f"{probe.name}: {fault}" for probe, fault in zip(probes, faults, strict=True) if fault]
        if whole:
            usable[i] = False
        reasons.append((*dict.fromkeys(whole), *single))
    return usable, tuple(reasons)


def probe_faults(stretch: Stretch, *, probes: tuple[Probe, ...], full_scale: int) -> list[str]:
    """Return the fault of each probe's samples, empty if none; the first that applies.

    Clipped at the end of the DAQ's range, no signal at all, outside the probe's linear range, or clipped short of the
    DAQ's range: by an input stage or a stuck converter, seen by its flat tops.
    """
    if not len(stretch.t):
        return ["no samples"] * len(probes)
    lowest, highest = stretch.counts.min(axis=0), stretch.counts.max(axis=0)
    nearest, farthest = stretch.x.max(axis=0), stretch.x.min(axis=0)
    often = (stretch.counts == highest).sum(axis=0), (stretch.counts == lowest).sum(axis=0)
    faults = []
    for p, probe in enumerate(probes):
        low, high = sorted((volts - probe.gap_voltage) / probe.sensitivity for volts in probe.linear_range)
        if highest[p] >= full_scale - 1 or lowest[p] <= -full_scale:
            faults.append("clipped")
        elif highest[p] == lowest[p]:
            faults.append(f"no signal, stays at {_volts(probe, stretch.x[0, p]):.2f} V")
        elif farthest[p] < low or nearest[p] > high:
            faults.append("gap out of range")
        elif often[0][p] > LONGEST_TOP and _flat_top(stretch.counts[:, p]):
            at = stretch.x[stretch.counts[:, p].argmax(), p]
            faults.append(f"clipped at {_volts(probe, at):.2f} V, short of the DAQ's range")
        elif often[1][p] > LONGEST_TOP and _flat_top(-stretch.counts[:, p]):
            at = stretch.x[stretch.counts[:, p].argmin(), p]
            faults.append(f"clipped at {_volts(probe, at):.2f} V, short of the DAQ's range")
        else:
            faults.append("")
    return faults


def aliased_orders(rows: Rows, orders: tuple[float, ...], *, rate: float) -> tuple[NDArray[np.bool_], Reasons]:
    """Return (row, order) where an order lies beyond what the sample rate [Hz] carries, with remarks (row,).

    The vectors there are not known, the row's other orders are: no reason to mask it.
    """
    limit = ALIAS_FREE * rate
    frequency = np.abs(np.outer(rows.omega, orders)) / TURN
    beyond = frequency > limit
    remarks = tuple(
        tuple(
            f"{orders[n]:g}X is not known: {frequency[i, n]:.0f} Hz, beyond the {limit:.0f} Hz that {rate:g} Hz carry"
            for n in np.flatnonzero(beyond[i])
        )
        for i in range(len(rows.t))
    )
    return beyond, remarks


def keyphasor_remarks(shaft: ShaftAngle, rows: Rows) -> Reasons:
    """Return remarks (row,) on the shaft angle: its own, and the repaired pulses a row's angle rests on."""
    return tuple(
        (*shaft.remarks, *dict.fromkeys(_overlapping(shaft.repairs, float(first), rows.turns)))
        for first in rows.first_turn
    )


def join_remarks(*parts: Reasons) -> Reasons:
    """Join the remarks of each row from all of `parts`, in order; at least one of them, all of the same rows."""
    return tuple(tuple(word for words in row for word in words) for row in zip(*parts, strict=True))


def _flat_top(counts: NDArray[np.int32]) -> bool:
    """Return True if the highest code of a moving signal is held, and is no rounded crest.

    A rounded crest spends time near its top as the root of the depth: a third of what it spends within ten steps it
    spends within one. The step is the smallest change there is, since a foreign file may hold fewer digits than codes.
    A top that is flat but noisy is not seen: what saturates like that leaves the probe's linear range first.
    """
    values = counts.astype(np.int64)
    change = np.abs(np.diff(values))
    step = int(change[change > 0].min())
    top = values.max()
    if top - values.min() < MOVING * step:
        return False
    on = values == top
    borders = np.flatnonzero(np.diff(np.concatenate([[False], on, [False]])))
    longest = (borders[1::2] - borders[0::2]).max()
    near = (values >= top - TOP_STEPS * step).sum()
    return bool(longest > LONGEST_TOP and near >= FEWEST_NEAR and on.sum() > FLAT_SHARE * near)


def _volts(probe: Probe, x: float) -> float:
    return probe.gap_voltage + probe.sensitivity * float(x)


def _overlapping(flaws: tuple[Flaw, ...], first_turn: float, turns: int) -> list[str]:
    """Return the reasons of the flawed turns that a row overlaps."""
    return [f.reason for f in flaws if f.first_turn < first_turn + turns and f.last_turn > first_turn]


def _speed_reversals(rows: Rows, spans: tuple[Span, ...]) -> list[str]:
    """Return per row the reason "speed reversal" where its speed goes against its run's direction; else empty."""
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
