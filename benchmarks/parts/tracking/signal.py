"""Run-ups in closed form for the order tracking's benchmark: nothing of rotorrig.processing is in them.

The shaft turns from 600 to 6000 rpm at constant acceleration. Each probe sees a 1X, a 2X and a 0.47X vibration, a
run-out that goes round with the shaft, white noise and its gap; a 24-bit converter makes counts of it. The keyphasor's
notch has flanks as wide as a probe over a slot sees them, the threshold passed at theta = 0 exactly; its pulses may
come early or late by a random time, and some may be missing.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from rotorrig.acquisition import Event
from rotorrig.acquisition.files import RecordingWriter
from rotorrig.rig import Provenance
from rotorrig.rig.config import RigConfig, parse
from rotorrig.rig.probes import Block, DaqInfo

ROOT = Path(__file__).parents[3]
Reals = NDArray[np.float64]
Complex = NDArray[np.complex128]

RATE = 25_600.0  # Hz
RPM = np.pi / 30
FULL_SCALE = 2**23  # counts
VOLTS_PER_COUNT = 24.0 / FULL_SCALE
IDLE, NOTCH = -2.0, -10.0  # V of the keyphasor
WIDTH, FLANK = np.radians(25), np.radians(10)  # of the notch, between the middles of its flanks, and of a flank
FIRST_ANGLE = -0.3  # rad, of the first sample
BLOCK = 5120  # scans


@dataclass(frozen=True, slots=True, kw_only=True)
class Line:
    """A vibration that goes with the shaft, Re(vector e^{j order theta}); (probe,) vectors [m, 0-peak]."""

    order: float
    vector: Complex


@dataclass(frozen=True, slots=True, kw_only=True)
class Resonance:
    """A vector (probe,) that follows the speed as an unbalance response does: vector r^2 / (1 - r^2 + 2j zeta r)."""

    critical: float  # rad/s
    damping: float
    vector: Complex

    def at(self, omega: Reals) -> Complex:
        """Return the vectors (..., probe) at speeds (...)."""
        r = (omega / self.critical)[..., None]
        return self.vector * r**2 / (1 - r**2 + 2j * self.damping * r)


@dataclass(frozen=True, slots=True, kw_only=True)
class RunUp:
    """A run-up and what the probes see of it."""

    probes: int = 4
    seconds: float = 30.0
    start: float = 600 * RPM  # rad/s
    end: float = 6000 * RPM
    lines: tuple[Line, ...] = ()
    resonance: Resonance | None = None  # of the 1X, instead of a constant one
    noise: float = 0.5e-6  # m rms, white up to half the sample rate
    jitter: float = 0.0  # s rms, of single pulses
    missed: float = 0.0  # share of the pulses
    seed: int = 0
    rate: float = RATE
    pulses: Reals = field(init=False)  # (turn,) s, by how much each pulse comes late; NaN: it is missing

    def __post_init__(self) -> None:
        rng = np.random.default_rng([self.seed, 1])
        turns = int(self.theta(np.array(self.seconds)) / (2 * np.pi)) + 2
        late = self.jitter * rng.standard_normal(turns)
        late[rng.random(turns) < self.missed] = np.nan
        object.__setattr__(self, "pulses", late)

    @property
    def acceleration(self) -> float:
        """Of the shaft [rad/s^2]."""
        return (self.end - self.start) / self.seconds

    @property
    def scans(self) -> int:
        """Number of scans."""
        return round(self.seconds * self.rate)

    def theta(self, t: Reals) -> Reals:
        """Return the shaft angle [rad]."""
        return FIRST_ANGLE + self.start * t + self.acceleration * t**2 / 2

    def omega(self, theta: Reals) -> Reals:
        """Return the speed [rad/s] at a shaft angle."""
        return np.sqrt(self.start**2 + 2 * self.acceleration * (theta - FIRST_ANGLE))

    def truth(self, order: float) -> Complex:
        """Return the constant vector (probe,) at an order."""
        return sum((line.vector for line in self.lines if line.order == order), np.zeros(self.probes, complex))

    def displacement(self, t: Reals, rng: np.random.Generator) -> Reals:
        """Return what the probes see, (sample, probe) [m] about the gap voltage's place."""
        theta = self.theta(t)[:, None]
        x = self.noise * rng.standard_normal((len(t), self.probes))
        for line in self.lines:
            wave = np.exp(1j * line.order * theta)
            x += wave.real * line.vector.real - wave.imag * line.vector.imag
        if self.resonance:
            x += (self.resonance.at(self.omega(theta[:, 0])) * np.exp(1j * theta)).real
        return x

    def keyphasor(self, t: Reals) -> Reals:
        """Return the keyphasor's volts (sample,)."""
        turn = np.round(self.theta(t) / (2 * np.pi)).astype(int)
        late = self.pulses[np.maximum(turn, 0)]
        psi = self.theta(t - np.nan_to_num(late)) - 2 * np.pi * turn
        inside = _flank(psi) - _flank(psi - WIDTH)
        return IDLE + (NOTCH - IDLE) * np.where(np.isfinite(late) & (turn >= 0), inside, 0.0)


def standard(probes: int = 4, **other: float) -> RunUp:
    """Return the benchmark's run-up: 50 um of 1X, 10 um of 2X, 5 um of 0.47X, 8 um of run-out, 0.5 um rms of noise.

    The run-out's orders 1 to 5 have 4, 2, 1, 0.6 and 0.4 um; all phases differ from probe to probe.
    """
    runout = dict(zip((1.0, 2.0, 3.0, 4.0, 5.0), (4e-6, 2e-6, 1e-6, 0.6e-6, 0.4e-6), strict=True))
    vibration = {1.0: 50e-6, 2.0: 10e-6, 0.47: 5e-6, 0.0: 30e-6}
    lines = [
        Line(order=order, vector=size * (np.exp(1j * (shift + np.arange(probes))) if order else np.ones(probes)))
        for shift, part in ((0.5, vibration), (2.0, runout))
        for order, size in part.items()
    ]
    return RunUp(probes=probes, lines=tuple(lines), **other)


def without(run: RunUp, *, orders: tuple[float, ...]) -> RunUp:
    """Return the run-up without what it has at these orders."""
    return replace(run, lines=tuple(line for line in run.lines if line.order not in orders))


def resonant(probes: int = 4) -> RunUp:
    """Return a run-up whose 1X passes a resonance at 2400 rpm, 100 um at its peak; without noise and 0.47X."""
    plain = without(standard(probes, noise=0.0), orders=(0.47, 1.0))
    return replace(
        plain,
        resonance=Resonance(critical=2400 * RPM, damping=0.02, vector=4e-6 * np.exp(0.5j + 1j * np.arange(probes))),
        lines=(*plain.lines, Line(order=1.0, vector=4e-6 * np.exp(1j * (2.0 + np.arange(probes))))),
    )


def rig_of(probes: int, rate: float = RATE) -> RigConfig:
    """Return the RK4 with so many probes in planes of two, the keyphasor on the channel behind them."""
    text = (ROOT / "configs/rk4.toml").read_text(encoding="utf-8")
    head, rest = text.split("[[probes]]", 1)
    tail = rest.split("[motor]", 1)[1]
    planes = "".join(
        f'[[probes]]\nname = "{1 + i // 2}{"xy"[i % 2]}"\nposition = "{200 + 60 * (i // 2)} mm"\n'
        f'angle = "{90 * (i % 2)} deg"\nchannel = {i}\n\n'
        for i in range(probes)
    )
    tail = tail.replace('sample_rate = "10 kHz"', f'sample_rate = "{rate:g} Hz"')
    return parse(f'{head}{planes}[keyphasor]\nchannel = {probes}\nedge = "falling"\n\n[motor]{tail}', where="benchmark")


def daq_of(run: RunUp) -> DaqInfo:
    """Return the converter: 24 bits over +-24 V."""
    return DaqInfo(
        model="closed form",
        serial="0",
        sample_rate=run.rate,
        channels=run.probes + 1,
        volts_per_count=(VOLTS_PER_COUNT,) * (run.probes + 1),
        full_scale_counts=FULL_SCALE,
    )


def blocks(run: RunUp, rig: RigConfig, scans: int = BLOCK) -> Iterator[Block]:
    """Yield the run-up as a DAQ's driver would, never more than a block of it in memory."""
    rng = np.random.default_rng([run.seed, 0])
    sensitivity = np.array([probe.sensitivity for probe in rig.probes])
    gap = np.array([probe.gap_voltage for probe in rig.probes])
    for first in range(0, run.scans, scans):
        t = np.arange(first, min(first + scans, run.scans)) / run.rate
        volts = np.column_stack([gap + run.displacement(t, rng) * sensitivity, run.keyphasor(t)])
        counts = np.clip(np.round(volts / VOLTS_PER_COUNT), -FULL_SCALE, FULL_SCALE - 1).astype(np.int32)
        yield Block(counts=counts, first_sample=first, t_ns=round(first * 1e9 / run.rate))


def write_run(path: Path, run: RunUp) -> Path:
    """Write the run-up as `run.mcap` and return its name."""
    rig = rig_of(run.probes, run.rate)
    source = Provenance(config_hash=rig.hash, code_version="benchmark")
    with RecordingWriter(path, rig, daq_of(run), source, overwrite=True) as writer:
        writer.write_event(Event(t_ns=0, kind="mark", text="up"))
        for block in blocks(run, rig):
            writer.write_block(block)
    return path


def _flank(psi: Reals) -> Reals:
    """Return 0 before, 1/2 at and 1 after psi = 0, over FLANK, with a slope that begins and ends at zero."""
    return (1 + np.sin(np.pi * np.clip(psi / FLANK, -0.5, 0.5))) / 2
