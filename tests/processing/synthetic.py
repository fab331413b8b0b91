"""Synthetic recordings with the truth in closed form."""

import numpy as np
from numpy.typing import NDArray

from rotorrig.acquisition.recording import Event, RawRecording
from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.probes.base import Block, DaqInfo
from rotorrig.rig.provenance import Provenance

VOLTS_PER_COUNT = 1e-6  # fine, so that rounding is below a nanometre
FULL_SCALE = 24_000_000  # +-24 V
PULSE = np.radians(20)  # width of the notch


def recording_of(
    rig: RigConfig,
    theta: NDArray[np.float64],
    x: NDArray[np.float64],
    *,
    rate: float,
    marks: list[tuple[float, str]] | None = None,
    blocks: list[tuple[int, int]] | None = None,
    notch: NDArray[np.float64] | None = None,
) -> RawRecording:
    """Return a recording of `x` (sample, 4 probes) in metres at shaft angles `theta` (sample,).

    `blocks` are sample ranges that were not lost; `notch` are the keyphasor's volts, by default a clean pulse.
    """
    volts = np.empty((len(theta), 5))
    volts[:, :4] = np.array([p.gap_voltage for p in rig.probes]) + x * np.array([p.sensitivity for p in rig.probes])
    volts[:, 4] = falling_notch(theta) if notch is None else notch
    counts = np.clip(np.round(volts / VOLTS_PER_COUNT), -FULL_SCALE, FULL_SCALE - 1).astype(np.int32)
    return RawRecording(
        rig=rig,
        daq=DaqInfo(
            model="synthetic",
            serial="0",
            sample_rate=rate,
            channels=5,
            volts_per_count=(VOLTS_PER_COUNT,) * 5,
            full_scale_counts=FULL_SCALE,
        ),
        blocks=tuple(
            Block(counts=counts[a:b], first_sample=a, t_ns=round(a * 1e9 / rate))
            for a, b in blocks or [(0, len(counts))]
        ),
        events=tuple(Event(t_ns=round(t * 1e9), kind="mark", text=text) for t, text in marks or []),
        motor=(),
        source=Provenance(config_hash=rig.hash, code_version="test", source="synthetic"),
        complete=True,
    )


def falling_notch(theta: NDArray[np.float64], *, slope: float = np.radians(2)) -> NDArray[np.float64]:
    """Return keyphasor volts: idle at -2 V, a notch at -10 V whose falling edge passes -6 V at theta = 0 exactly.

    The flanks are straight in angle and `slope` wide.
    """
    psi = np.mod(theta + np.pi, 2 * np.pi) - np.pi
    fall = np.clip(psi / slope + 0.5, 0, 1)
    rise = np.clip((psi - PULSE) / slope + 0.5, 0, 1)
    return -2 - 8 * (fall - rise)


def chirp(t: NDArray[np.float64], *, start: float, rate: float, theta_0: float = 0.0) -> NDArray[np.float64]:
    """Return the shaft angle at constant acceleration `rate` [rad/s^2] from `start` [rad/s]."""
    return theta_0 + start * t + rate * t**2 / 2
