"""Signals of a rotor whose answers are known: notch pulses at given shaft angles, vibration about the gap."""

import numpy as np
from numpy.typing import NDArray

from rotorrig.rig.probes.base import Block

RATE = 10_000.0
VOLTS_PER_COUNT = 24 / 32768
EDGE = 2 / 360  # turns; the falling edge lasts this long, its middle is shaft angle zero
WIDTH = 20 / 360  # turns; the pulse, before its falling edge


def pulse_volts(turns: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return -10 V with a pulse to -2 V that falls through -6 V at every whole turn."""
    x = (turns + 0.5) % 1 - 0.5  # -0.5 to 0.5 about the edge
    up = np.clip((x + WIDTH) / EDGE + 0.5, 0, 1)
    down = np.clip(x / EDGE + 0.5, 0, 1)
    return -10.0 + 8.0 * (up - down)


def to_counts(volts: NDArray[np.float64]) -> NDArray[np.int32]:
    return np.clip(np.round(volts / VOLTS_PER_COUNT), -32768, 32767).astype(np.int32)


def block(keyphasor: NDArray[np.float64], *probes: NDArray[np.float64] | float, first_sample: int = 0) -> Block:
    """Return a five-channel block: probes [m] about the gap on channels 0 to 3, keyphasor [V] on channel 4."""
    metres = np.zeros((len(keyphasor), 4))
    for i, probe in enumerate(probes):
        metres[:, i] = probe
    counts = to_counts(np.column_stack([-10.0 + 7874.0 * metres, keyphasor]))
    return Block(counts=counts, first_sample=first_sample, t_ns=round(first_sample * 1e9 / RATE))


def cut(whole: Block, at: list[int]) -> list[Block]:
    """Return `whole` in pieces that begin at the given samples."""
    edges = [0, *at, len(whole.counts)]
    return [
        Block(
            counts=whole.counts[a:b],
            first_sample=whole.first_sample + a,
            t_ns=round((whole.first_sample + a) * 1e9 / RATE),
        )
        for a, b in zip(edges, edges[1:], strict=False)  # noqa: RUF007 (the pieces, not the pairs, are meant)
        if b > a
    ]
