"""Hand-made results of a run: a rotor on isotropic supports in closed form, so that every figure is known."""

import dataclasses
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from rotorrig.acquisition.recording import RawRecording
from rotorrig.balancing import Balance, Holes, Task, balance
from rotorrig.identify.adequacy.misfit import Misfit
from rotorrig.identify.diagnosis import Diagnosis, Verdict
from rotorrig.identify.discovery import ForceOverSpeed, MissingForce, Rival
from rotorrig.identify.identification import (
    Deviation,
    Estimate,
    Fit,
    Identification,
    NameplateCheck,
    NameplateFinding,
    Optimum,
    Pull,
    SearchTrace,
    Stage,
)
from rotorrig.identify.verdict.cause import Cause, ParameterValue
from rotorrig.identify.verdict.gain import Gain, Shift
from rotorrig.identify.verdict.next_run.choice import NextRun
from rotorrig.identify.verdict.verdict import HiddenEffect
from rotorrig.processing.pipeline import track
from rotorrig.processing.response import OrderTrackedResponse, Run
from rotorrig.rig.config.description import RigConfig, load, parse
from rotorrig.rig.probes.base import Block, DaqInfo
from rotorrig.rig.provenance import Provenance

ROOT = Path(__file__).parents[2]
RAD = np.pi / 30  # rad/s per rpm
CRITICAL = 2230 * RAD
DAMPING = 0.04
ECCENTRICITY = 15e-6  # m: the peak is e / (2 zeta) = 187.5 um
PHASE = np.radians(40)
SIGMA = 0.3e-6  # m, of each component of z
SOURCE = Provenance(
    config_hash="0123456789abcdef", code_version="0.1.0", source="run.mcap", source_hash="fedcba9876543210"
)


def jeffcott(omega: NDArray[np.float64], damping: float = DAMPING) -> NDArray[np.complex128]:
    """The x phasor of a disk on a massless shaft [m], forward circular whirl: y lags it by 90 degrees."""
    r = omega / CRITICAL
    return ECCENTRICITY * np.exp(1j * PHASE) * r**2 / (1 - r**2 + 2j * damping * r)


def make_response(rig: RigConfig, *, rows: int = 365) -> OrderTrackedResponse:
    """A slow roll of ten rows, then `rows` up and as many down; 2X peaks at half the critical speed."""
    rng = np.random.default_rng(8)
    up = np.linspace(480, 3600, rows) * RAD
    omega = np.concatenate([np.full(10, 240 * RAD), up, up[::-1]])
    run = np.repeat([0, 1, 2], [10, rows, rows])
    angles = np.array([p.angle for p in rig.probes])
    runout = 3e-6 * np.exp(1j * (np.arange(len(angles)) + 0.5))
    z = np.zeros((len(omega), len(angles), 3), dtype=complex)
    z[:, :, 1] = runout + jeffcott(omega)[:, None] * np.exp(-1j * angles)
    z[:, :, 2] = 0.05 * jeffcott(2 * omega)[:, None] * np.exp(-1j * angles)
    z[:, :, 1:] += SIGMA * (rng.standard_normal((*z.shape[:2], 2)) + 1j * rng.standard_normal((*z.shape[:2], 2)))
    slow_roll = np.zeros((len(angles), 3), dtype=complex)
    slow_roll[:, 1] = runout + jeffcott(np.array([240 * RAD])) * np.exp(-1j * angles)
    covariance = np.broadcast_to(SIGMA**2 * np.eye(2 * len(angles)), (len(omega), 3, 2 * len(angles), 2 * len(angles)))
    return OrderTrackedResponse(
        rig=rig,
        probes=tuple(p.name for p in rig.probes),
        orders=(0.0, 1.0, 2.0),
        runs=(Run(name="slow roll", direction=0), Run(name="up", direction=1), Run(name="down", direction=-1)),
        run=run,
        t=np.concatenate([np.linspace(0, 10, 10), np.linspace(12, 116, rows), np.linspace(118, 160, rows)]),
        omega=omega,
        alpha=np.gradient(omega),
        revolutions=np.full(len(omega), 8.0),
        window="hann",
        z=z,
        covariance=covariance,
        slow_roll=slow_roll,
        slow_roll_covariance=covariance[0],
        slow_roll_omega=240 * RAD,
        usable=np.ones(z.shape[:2], dtype=bool),
        reasons=((),) * len(omega),
        keyphasor_t=np.empty(0),
        source=SOURCE,
    )


def prediction_of(response: OrderTrackedResponse, damping: float = DAMPING) -> NDArray[np.complex128]:
    """1X as measured: the runout of `make_response` and the closed form, without the noise."""
    angles = np.array([p.angle for p in response.rig.probes])
    runout = 3e-6 * np.exp(1j * (np.arange(len(angles)) + 0.5))
    return runout + jeffcott(response.omega, damping)[:, None] * np.exp(-1j * angles)


def make_diagnosis(response: OrderTrackedResponse, prediction: NDArray[np.complex128], *, adequate: bool) -> Diagnosis:
    residual = np.full(response.z.shape, np.nan + 0j)
    residual[:, :, 1] = response.order(1.0) - prediction
    residual[:, :, 2] = response.order(2.0)
    peak = float(np.abs(residual[:, 0, 1]).max())
    worst = Misfit(
        run="down",
        probe="1x",
        order=1.0,
        speed_from=2100 * RAD,
        speed_to=2350 * RAD,
        sigma=peak / SIGMA / 2,
        residual=peak,
        relative=-0.2,
        phase=-0.03,
        sentence="In the down run, 2100 to 2350 rpm, probe 1x departs from the model.",
    )
    words = "The model agrees with the run." if adequate else "The model does not agree with the run near 2230 rpm."
    return Diagnosis(
        verdict=Verdict.ADEQUATE if adequate else Verdict.UNEXPLAINED,
        sentence=words,
        false_alarm_rate=0.01,
        noise_floor=SIGMA,
        chi2=2950.0 if adequate else 295000.0,
        dof=2910,
        p=0.3 if adequate else 0.0,
        worst=(worst,),
        residual=residual,
        sigmas=np.abs(residual) / (np.sqrt(2) * SIGMA),
        source=SOURCE,
    )


OFF = Deviation(
    kind="bearing_position",
    where="spring",
    title="position of bearing spring",
    words="bearing spring sits 2.10 ± 0.20 mm further from the coupling than the config says",
    value=2.1e-3,
    sigma=2e-4,
    unit="m",
    nameplate=0.481,
    nameplate_unit="m",
    pull=5.1,
    evidence=19.0,
)
WRONG_CONFIG = NameplateCheck(
    pulls=(Pull(group="positions", sigmas=4.6, deviations=(OFF,)),),
    findings=(NameplateFinding(group="positions", sigmas=4.6, deviation=OFF),),
)


def make_cause(label: str, title: str, *, chosen: bool = False, evidence: float, after: float) -> Cause:
    """A bow of 18 um at 110 degrees, whatever it is called."""
    effect, _, where = label.partition(", ")
    size, angle = 18e-6, np.radians(110)
    return Cause(
        label=label,
        effect=effect,
        where=where,
        title=title,
        words=f"The shaft shows a {title} of 18 um at 110 deg.",
        chosen=chosen,
        plausible=True,
        evidence=evidence,
        lam=evidence + 15,
        heldout_before=5.2e-6,
        heldout_after=after,
        parameters={
            "bow": ParameterValue(value=size, unit="m", sigma=3e-7),
            "bow angle": ParameterValue(value=angle, unit="rad", sigma=np.radians(1.0)),
        },
        theta={"bow re": size * np.cos(angle), "bow im": size * np.sin(angle)},
        sigmas={"bow re": 3e-7, "bow im": np.inf},
    )


def make_gain(base: dict[str, Shift]) -> Gain:
    return Gain(
        heldout_before=5.2e-6, heldout_after=4.1e-7, noise_floor=3.98e-7, on="blocks of speeds in turn", base=base
    )


def make_named(response: OrderTrackedResponse, base: NDArray[np.complex128]) -> Diagnosis:
    """A bow found in a response that `base` does not describe; the extended model is the closed form itself."""
    wrong = make_diagnosis(response, base, adequate=False)
    after = wrong.residual.copy()
    after[:, :, 1] = response.order(1.0) - prediction_of(response)
    return dataclasses.replace(
        wrong,
        verdict=Verdict.NAMED,
        sentence="The model is NOT adequate; a bow of the shaft explains it.",
        causes=(
            make_cause("bow", "residual bow", chosen=True, evidence=812.0, after=4.1e-7),
            make_cause("runout, plane 2", "probe runout", evidence=640.0, after=1.3e-6),
            dataclasses.replace(make_cause("delay", "delay", evidence=-11.0, after=np.nan), plausible=False),
        ),
        tied=(("bow", "runout, plane 2"),),
        next_run=NextRun(
            kind="trial mass",
            words="A run with a trial mass of 12 g mm would tell bow from runout.",
            lam=210.0,
            separates=("bow", "runout, plane 2"),
        ),
        gain=make_gain({"kxx": Shift(before=31200.0, after=33900.0, sigma=120.0, unit="N/m")}),
        hidden=(HiddenEffect(effect="internal_damping", smallest=40.0, unit="N s/m", missing="a run in reverse"),),
        character="What is left is strongest at 2X.",
        extended_residual=after,
        extended_sigmas=np.abs(after) / (np.sqrt(2) * SIGMA),
        responses=((response.source.source_hash, len(response.omega)),),
    )


def swept_counts(rig: RigConfig, *, seconds: float = 16.0, rate: float = 10_000.0) -> tuple[NDArray[np.int32], DaqInfo]:
    """Counts (sample, channel) of a run from 480 to 3000 rpm and back to 1500, noise of 3 mV, no runout."""
    t = np.arange(int(seconds * rate)) / rate
    at = [0, 1, 0.65 * seconds, 0.7 * seconds, seconds - 0.5, seconds]
    omega = np.interp(t, at, np.array([480, 480, 3000, 3000, 1500, 1500]) * RAD)
    theta = np.cumsum(omega) / rate
    angles = np.array([p.angle for p in rig.probes])
    x = (jeffcott(omega)[:, None] * np.exp(1j * (theta[:, None] - angles))).real
    volts = -10 + 7874 * x + 0.003 * np.random.default_rng(1).standard_normal(x.shape)
    past = np.mod(theta + np.pi, 2 * np.pi) - np.pi  # rad past the mark; the flank crosses -5 V there
    pulse = np.where(past < 0.3, np.clip(-5 - 50 * past, -8.0, -2.0), -2.0)
    scale = 20 / 2**23
    info = DaqInfo(
        model="test", serial="1", sample_rate=rate, channels=5, volts_per_count=(scale,) * 5, full_scale_counts=2**23
    )
    return np.round(np.column_stack([volts, pulse]) / scale).astype(np.int32), info


@pytest.fixture(scope="session")
def brief_rig(rig_config: RigConfig) -> RigConfig:
    """The RK4 with a sweep of some seconds."""
    text = rig_config.text
    for old, new in (
        ('"30 rpm/s"', '"200 rpm/s"'),
        ('time = "10 s"', 'time = "3 s"'),
        ('end = "3600 rpm"', 'end = "1500 rpm"'),
    ):
        assert old in text
        text = text.replace(old, new)
    return parse(text, where="brief rk4.toml")


@pytest.fixture(scope="session")
def rig() -> RigConfig:
    return load(ROOT / "configs" / "rk4.toml")


@pytest.fixture(scope="session")
def response(rig: RigConfig) -> OrderTrackedResponse:
    return make_response(rig)


@pytest.fixture(scope="session")
def identification(response: OrderTrackedResponse) -> Identification:
    fit = Fit(
        name="whole sweep",
        band=(480 * RAD, 3600 * RAD),
        estimates=(
            Estimate(
                name="kxx",
                value=34210.0,
                sigma=120.0,
                unit="N/m",
                nameplate=33900.0,
                interval=(33976.0, 34446.0),
                interval_by="covariance",
            ),
            Estimate(name="kyy", value=33950.0, sigma=140.0, unit="N/m", nameplate=34600.0),
            Estimate(name="cxx", value=14.2, sigma=0.9, unit="N s/m", nameplate=15.0),
            Estimate(
                name="cyy",
                value=1e3,
                sigma=np.inf,
                unit="N s/m",
                nameplate=15.0,
                determined=False,
                bounds=(1.0, 1e3),
                interval=(62.0, 1e3),
                interval_by="profile likelihood",
            ),
            Estimate(name="u", value=1.62e-5, sigma=1.1e-7, unit="kg m", nameplate=1.5e-5),
            Estimate(name="phase", value=0.698, sigma=0.004, unit="rad", nameplate=0.0),
        ),
        nuisances=(
            Estimate(name="E", value=0.0031, sigma=0.0052, unit="", nameplate=0.0),
            Estimate(name="angle 1x", value=0.01, sigma=0.008, unit="rad", nameplate=0.0),
        ),
        unknowns=("kxx", "kyy", "cxx", "cyy", "u"),
        optima=(Optimum(theta=(34210.0, 33950.0, 14.2, 1e3, 1.62e-5), cost=0.0123),),
        objective="f1",
        evaluations=4321,
        stop="converged",
        trace=SearchTrace(
            method="seed",
            stages=(
                Stage(name="genetic", steps=11, evaluations=1500),
                Stage(name="local", steps=9, evaluations=2421),
                Stage(name="far", steps=1, evaluations=400),
            ),
            reduced=1,
            heads=np.array([[3e4, 4e4, 10.0, 900.0, 1e-5], [2e4, 9e4, 5.0, 20.0, 3e-5]]),
            points=np.geomspace([1e2, 1e2, 1.0, 1.0, 1e-7], [1e6, 1e6, 1e3, 1e3, 1e-3], 30),
        ),
        seed=7,
        chi2=2950.0,
        dof=2910,
        prediction=prediction_of(response),
        words=("cyy ran into its bound: this data does not give it.",),
    )
    band = dataclasses.replace(fit, name="chapter", band=(480 * RAD, 2140 * RAD), words=(), nuisances=())
    return Identification(fits=(fit, band), effects=(), wall_s=12.3, source=SOURCE)


@pytest.fixture(scope="session")
def good(response: OrderTrackedResponse) -> Diagnosis:
    adequate = make_diagnosis(response, prediction_of(response), adequate=True)
    adequate.sigmas[:, :, 2] = np.nan  # a run without 2X to speak of
    return adequate


@pytest.fixture(scope="session")
def poor(response: OrderTrackedResponse) -> Diagnosis:
    return make_diagnosis(response, prediction_of(response, damping=0.055), adequate=False)


@pytest.fixture(scope="session")
def named(response: OrderTrackedResponse) -> Diagnosis:
    return make_named(response, prediction_of(response, damping=0.055))


@pytest.fixture(scope="session")
def poorly_fitted(response: OrderTrackedResponse, identification: Identification) -> Identification:
    fit = dataclasses.replace(identification.fits[0], prediction=prediction_of(response, damping=0.055), chi2=295000.0)
    return dataclasses.replace(identification, fits=(fit,))


@pytest.fixture(scope="session")
def balanced(response: OrderTrackedResponse) -> Balance:
    """By a trial mass of 12 g mm at 90 degrees that adds half of the vibration, a right angle ahead of it."""
    z = response.z.copy()
    z[:, :, response.orders.index(1.0)] *= 1 + 0.5j
    runs = tuple(dataclasses.replace(run, trial_unbalance={"disk": 12e-6j}) for run in response.runs)
    source = dataclasses.replace(response.source, source_hash="11" * 8)
    trial = dataclasses.replace(response, z=z, slow_roll=response.slow_roll, runs=runs, source=source)
    holes = {"disk": Holes(count=16, masses=(2e-4, 5e-4), radius=0.03)}
    return balance([response, trial], Task(holes=holes, radii={"disk": 0.03}))


@pytest.fixture(scope="session")
def closed_form() -> Callable[[NDArray[np.float64]], NDArray[np.complex128]]:
    """The x phasor [m] over speed [rad/s]."""
    return jeffcott


@pytest.fixture(scope="session")
def swept(rig: RigConfig) -> tuple[NDArray[np.int32], DaqInfo]:
    """Counts (sample, channel) of a run-up and a coast-down."""
    return swept_counts(rig)


@pytest.fixture(scope="session")
def recording(rig: RigConfig, swept: tuple[NDArray[np.int32], DaqInfo], response: OrderTrackedResponse) -> RawRecording:
    """A forward circular whirl from 480 to 3000 rpm and back to 1500, without runout."""
    counts, info = swept
    block = Block(counts=counts, first_sample=0, t_ns=0)
    return RawRecording(rig=rig, daq=info, blocks=(block,), events=(), motor=(), source=response.source, complete=True)


@pytest.fixture(scope="session")
def tracked(recording: RawRecording) -> OrderTrackedResponse:
    """The response tracked from `recording`."""
    return track(recording)


def make_missing(**changes: Any) -> MissingForce:
    """A force at the spring bearing of the RK4 that is ahead of its motion, and follows its law."""
    omega = np.linspace(60.0, 300.0, 12)
    motion = np.stack([50e-6 / (1 + (omega - 180.0) ** 2 / 900), 5e-6 * np.ones(12)], axis=-1) + 0j
    places = np.arange(0.0, 0.565, 0.01)
    weight = np.exp(-(((places - 0.485) / 0.01) ** 2) / 2)
    force = ForceOverSpeed(
        omega=omega,
        force=1600j * motion + 1e-3,
        sigma=np.full((12, 2), 2e-3),
        law=1500j * motion,
        motion=motion,
        recording=0,
    )
    usual = MissingForce(
        kind="force",
        words="at 485 ± 10 mm from the coupling (bearing spring is at 481 mm) acts a force across the motion",
        laws=("cross-coupled stiffness",),
        like=("a fluid film",),
        place=0.485,
        place_sigma=0.01,
        places=places,
        probability=weight / weight.sum(),
        rivals=(Rival(words="probe 2x reads besides 3 % of the motion it reads", evidence=9.4),),
        over_speed=force,
        shortfall="",
    )
    return dataclasses.replace(usual, **changes)
