"""Responses of the rotor model itself, with noise like the tracked one: what an interval's statistics are tested on.

A case is a rig of random coefficients and unbalance whose nuisances are drawn from the config's priors, swept up and
down through its critical speeds. The noise is white in the probes and a random force at the identified bearings, which
the rotor answers to; rows of vectors are drawn from the covariance which that spectrum gives them. The fit is told
another one: what the spectrum is estimated to be from a recording's worth of segments, as the pipeline does.

Nothing here tests the model, which is the same on both sides; nor the jitter of the keyphasor, of which there is none.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotorrig.processing import OrderTrackedResponse, Run
from rotorrig.processing.noise.covariance import NoiseSpectrum, row_covariance
from rotorrig.processing.rows import Rows
from rotorrig.rig import Provenance
from rotorrig.rig.config import RPM, RigConfig
from rotorrig.rig.config.description import from_si
from rotorrig.sims.rotor.model import RotorModel, assemble, reduce, scale_properties, with_bearing
from rotorrig.sims.rotor.steady.harmonic_response import dynamic_stiffness, probe_response
from rotorrig.sims.rotor.swept import TURN, Timeline
from rotorrig.sims.rotor.swept.swept_response import swept_response

Reals = NDArray[np.float64]
Complex = NDArray[np.complex128]

TURNS = 8  # of a row
SLOWEST, FASTEST = 480 / RPM, 3600 / RPM  # rad/s
SLOW_ROLL, SLOW_ROLL_ROWS = 240 / RPM, 5
LOOKS = (
    25  # independent segments per bin: what 80 s of recording have, at half overlap, Kaiser's window and lines kept out
)
BIN = 0.5  # Hz
WHITE = 3.6e-18  # m^2/Hz two-sided: 1.5 mV rms in the 5 kHz of a probe of 7.874 mV/um
FORCE = 5e-7  # N^2/Hz two-sided, x and y of an identified bearing
CURVED_AT = 300e-6  # m, where a probe's scale is off by its linearity
EXTRA_MODES = 14  # more than the fit's own reduced model keeps


@dataclass(frozen=True, slots=True, kw_only=True)
class Design:
    """What the cases of a group have in common."""

    ramp: float = 90 / RPM  # rad/s^2
    noise: float = 1.0  # factor on the standard deviations
    linearity: float = 0.003  # of the reading: drawn as the fit takes it, for every probe
    fastest: float = FASTEST
    c: tuple[float, float] = (5.0, 40.0)  # N s/m, log-uniform
    c_lowest: float = 1.0  # N s/m: the bound of the search


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """One simulated measurement and what is to be found in it."""

    response: OrderTrackedResponse
    truth: Mapping[str, float]  # estimate -> SI


def draw(rig: RigConfig, design: Design, *, rng: np.random.Generator) -> Case:
    """Return a random case of a rig with one group of bearings and one plane of unbalance."""
    rig = _searched(rig, design)
    assert rig.identify is not None
    (group,), (plane,) = rig.identify.bearings, rig.identify.unbalance
    k, c = np.exp(rng.uniform(*np.log([15e3, 80e3]), 2)), np.exp(rng.uniform(*np.log(design.c), 2))
    u, phase = rng.uniform(5e-6, 30e-6), rng.uniform(-np.pi, np.pi)
    model = with_bearing(_as_built(rig, rng), group, np.diag(k), np.diag(c))
    pulses = _pulses(design)
    rows = _rows(pulses)
    amount = {plane: u * np.exp(1j * phase)}
    swept = swept_response(
        reduce(model, modes=EXTRA_MODES),
        Timeline(pulses),
        t=rows.t,
        revolutions=np.full(len(rows.t), TURNS),
        window="blackman",
        unbalance=amount,
    )
    z = np.concatenate([swept, probe_response(model, SLOW_ROLL, unbalance=amount)])
    probes, prior = len(rig.probes), rig.prior
    z = (1 + prior.probe_gain * rng.standard_normal(probes)) * z
    motion = z - z[-1]  # read a scale that is bent: r + b r^3, b a share of `linearity` at CURVED_AT
    z += 0.75 * design.linearity * rng.standard_normal(probes) * np.abs(motion / CURVED_AT) ** 2 * motion
    z += prior.runout * _complex_normal(probes, rng)
    spectrum = _spectrum(model, group, design)
    z += _drawn(_covariance(spectrum, rows), rng)
    told = _covariance(_estimated(spectrum, rng), rows)
    truth = dict(zip(("kxx", "kyy", "cxx", "cyy", "u", "phase"), (*k, *c, u, phase), strict=True))
    return Case(response=_response(rig, rows, pulses, z, told), truth=truth)


def _searched(rig: RigConfig, design: Design) -> RigConfig:
    table = rig.model_dump(mode="json")
    table["identify"] |= {"bands": {}, "c_bounds": [design.c_lowest, 1e3]}
    table["prior"] |= {"probe_linearity": design.linearity, "model_error": 0.0, "repeatability": 0.0}  # none is drawn
    return from_si(table)


def _as_built(rig: RigConfig, rng: np.random.Generator) -> RotorModel:
    """Return the rotor with modulus, masses, the other bearings and the probes' angles drawn from their priors."""
    prior = rig.prior
    assert rig.identify is not None
    probes = tuple(
        probe.model_copy(update={"angle": probe.angle + prior.probe_angle * rng.standard_normal()})
        for probe in rig.probes
    )
    model = assemble(rig.model_copy(update={"probes": probes}))
    sought = {name for group in rig.identify.bearings for name in group}
    for bearing in rig.bearings:
        if bearing.name not in sought:
            there = model.bearing(bearing.name)
            factors = 1 + prior.bearing * rng.standard_normal(2)
            model = with_bearing(model, bearing.name, factors[:, None] * there.K, there.C)
    return scale_properties(
        model,
        youngs_modulus=1 + prior.youngs_modulus * rng.standard_normal(),
        disk_mass=1 + prior.disk_mass * rng.standard_normal(),
    )


def _pulses(design: Design) -> Reals:
    """Return the times of the keyphasor's pulses: up at a constant rate, and down again."""
    low, high, rate = SLOWEST, design.fastest, design.ramp
    turns = (high**2 - low**2) / (2 * rate) / TURN
    up = (np.sqrt(low**2 + 2 * rate * TURN * np.arange(int(turns))) - low) / rate
    end = (high - low) / rate
    return np.concatenate([up, 2 * end - up[::-1]])


def _rows(pulses: Reals) -> Rows:
    """Return rows one after another, as the pipeline lays them, up and down."""
    timeline = Timeline(pulses)
    first = np.arange(0, len(pulses) - TURNS, TURNS)
    middle = first + TURNS // 2
    t = pulses[middle]
    return Rows(
        turns=TURNS,
        run=np.where(t < pulses[-1] / 2, 0, 1),
        first_turn=first,
        begin=pulses[first],
        end=pulses[first + TURNS],
        t=t,
        omega=timeline.omega(t),
        alpha=timeline.alpha(t),
    )


def _spectrum(model: RotorModel, group: tuple[str, ...], design: Design) -> NoiseSpectrum:
    """Return the probes' noise: white, and the rotor's answer to a random force at the bearings sought."""
    frequency = np.arange(0.0, 1.3 * design.fastest / TURN, BIN)
    Z = dynamic_stiffness(reduce(model), TURN * frequency)
    reduced = reduce(model)
    loads = np.concatenate([reduced.bearing(name).rows for name in group]).T
    answer = reduced.probes @ np.linalg.solve(Z, np.broadcast_to(loads, (len(Z), *loads.shape)))
    density = FORCE * answer @ answer.conj().swapaxes(1, 2) + WHITE * np.eye(len(reduced.probes))
    return NoiseSpectrum(frequency=frequency, density=design.noise**2 * density)


def _estimated(spectrum: NoiseSpectrum, rng: np.random.Generator) -> NoiseSpectrum:
    """Return the mean of `LOOKS` periodograms of that noise, bin by bin: a complex Wishart matrix."""
    root = np.linalg.cholesky(spectrum.density)
    seen = root @ _complex_normal((*root.shape[:2], LOOKS), rng) / np.sqrt(2 * LOOKS)
    return NoiseSpectrum(frequency=spectrum.frequency, density=seen @ seen.conj().swapaxes(1, 2))


def _covariance(spectrum: NoiseSpectrum, rows: Rows) -> Reals:
    """Return the covariance of every row and of the slow roll, (row + 1, 2 probe, 2 probe) m^2."""
    duration = TURNS * TURN / SLOW_ROLL
    slow = Rows(
        turns=TURNS,
        run=np.zeros(1, dtype=np.intp),
        first_turn=np.zeros(1, dtype=np.int64),
        begin=np.zeros(1),
        end=np.array([duration]),
        t=np.array([duration / 2]),
        omega=np.array([SLOW_ROLL]),
        alpha=np.zeros(1),
    )
    each = [row_covariance(spectrum, part, orders=(1.0,))[:, 0] for part in (rows, slow)]
    return np.concatenate([each[0], each[1] / SLOW_ROLL_ROWS])


def _drawn(covariance: Reals, rng: np.random.Generator) -> Complex:
    pairs = (np.linalg.cholesky(covariance) @ rng.standard_normal((*covariance.shape[:2], 1)))[..., 0]
    return pairs[:, 0::2] + 1j * pairs[:, 1::2]


def _complex_normal(shape: int | tuple[int, ...], rng: np.random.Generator) -> Complex:
    """Draw numbers with re and im of variance one each."""
    return rng.standard_normal(shape) + 1j * rng.standard_normal(shape)


def _response(rig: RigConfig, rows: Rows, pulses: Reals, z: Complex, covariance: Reals) -> OrderTrackedResponse:
    return OrderTrackedResponse(
        rig=rig,
        probes=tuple(probe.name for probe in rig.probes),
        orders=(1.0,),
        runs=(Run(name="up", direction=1), Run(name="down", direction=-1)),
        run=rows.run,
        t=rows.t,
        omega=rows.omega,
        alpha=rows.alpha,
        revolutions=np.full(len(rows.t), float(TURNS)),
        window="blackman",
        z=z[:-1, :, None],
        covariance=covariance[:-1, None],
        slow_roll=z[-1, :, None],
        slow_roll_covariance=covariance[-1:],
        slow_roll_omega=SLOW_ROLL,
        usable=np.ones(z[:-1].shape, dtype=bool),
        reasons=((),) * len(rows.t),
        keyphasor_t=pulses,
        source=Provenance(config_hash=rig.hash, code_version="", source="matched run"),
    )
