"""The verbs as functions: track, identify, diagnose, report, simulate.

They take paths, as text or Path, or what `rr.read` returned.
"""

import tempfile
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Literal

from rotorrig.acquisition import RawRecording, WaveformSource
from rotorrig.acquisition.files import open_recording
from rotorrig.app.python.given import OneResponse, PathLike, Responses, read_responses, rig_of
from rotorrig.app.python.recording import Recording
from rotorrig.app.python.response import Response
from rotorrig.app.python.results import Diagnosis, Identification
from rotorrig.identify import Diagnosis as Judgement
from rotorrig.identify import Identification as Fits
from rotorrig.identify import diagnose as judge
from rotorrig.identify import identify as fit
from rotorrig.identify.base_model import ObjectiveName, SearchName
from rotorrig.processing import Spacing, SpeedWindow, Tracking, pipeline
from rotorrig.rig.config import RigConfig, read_quantity, read_trial_mass


def track(
    recording: PathLike | Recording | RawRecording,
    *,
    turns: int = 8,
    orders: Sequence[float] = Tracking().orders,
    method: Literal["resampling", "least-squares", "vold-kalman"] = "resampling",
    every: str | None = None,
    slow_roll: str | None = None,
    trial: Iterable[str] | None = None,
) -> Response:
    """Track the orders of a recording, as `rotor track`: `every` "10 rpm" or "0.5 s", `slow_roll` "200 to 400 rpm".

    `trial` are masses such as "disk: 12 g mm at 90 deg" instead of those noted in the recording. Raises DataError,
    ConfigError.
    """
    settings = Tracking(
        turns=turns,
        orders=tuple(orders),
        method=method,
        every=Spacing.read(every, where="every") if every else None,
        slow_roll=SpeedWindow.read(slow_roll, where="slow_roll") if slow_roll else None,
    )
    with ExitStack() as stack:
        source: WaveformSource
        if isinstance(recording, RawRecording):
            source = recording
        else:
            path = recording.path if isinstance(recording, Recording) else Path(recording)
            source = stack.enter_context(open_recording(path))
        planes = source.rig.unbalance_planes
        masses = None if trial is None else [read_trial_mass(text, planes=planes) for text in trial]
        return Response.of(pipeline.track(source, settings, trial=masses))


def identify(
    responses: Responses,
    *,
    objective: ObjectiveName = "residual",
    search: SearchName | None = None,
    profile: bool = False,
    config: PathLike | RigConfig | None = None,
    seed: int = 0,
) -> Identification:
    """Fit bearing stiffness, damping and unbalance to one or more responses of a rig, as `rotor identify`.

    `config` replaces the model in the responses. Raises DataError, ConfigError.
    """
    measured = read_responses(responses, config=config)
    return Identification.of(fit(measured, objective=objective, method=search, profile=profile, seed=seed))


def diagnose(
    responses: Responses,
    *,
    holdout: OneResponse | None = None,
    config: PathLike | RigConfig | None = None,
    model: Literal["swept", "quasi-static"] = "swept",
    time_limit: str | None = None,
    seed: int = 0,
) -> Diagnosis:
    """Test whether the model is adequate and, if not, name what it lacks, as `rotor diagnose`.

    `holdout` is a response that no fit sees. After `time_limit`, "5 min", it ends with the best so far. Raises
    DataError, ConfigError.
    """
    used = read_responses(responses, config=config)
    unseen = read_responses(holdout, config=used[0].rig)[0] if holdout is not None else None
    return Diagnosis.of(judge(used, holdout=unseen, model=model, seed=seed, go_on=_until(time_limit)))


def report(
    path: PathLike,
    response: OneResponse,
    *,
    identification: Fits | None = None,
    diagnosis: Judgement | None = None,
) -> Path:
    """Write the self-contained HTML report of a response. Raises DataError."""
    from rotorrig.app.report import write_report

    measured = read_responses(response)[0]
    write_report(Path(path), response=measured, identification=identification, diagnosis=diagnosis)
    return Path(path)


def simulate(
    config: PathLike | RigConfig,
    out: PathLike,
    *,
    plan: str = "default",
    faults: Mapping[str, Mapping[str, float]] | None = None,
    trial: Sequence[str] = (),
    seed: int = 0,
    rate: float = 20.0,
    overwrite: bool = False,
) -> Recording:
    """Sweep a simulated rig behind real wire protocols and return its recording, written to `out`.

    `faults` are what is wrong with the rig, by the names and sizes of docs/plant.md in SI, {"bow": {"amount": 20e-6,
    "angle": 1.9}}, beside those for the config's effects. `seed` draws how far the rig is off its
    nameplate, `rate` is simulated seconds per second, at most. Raises ConfigError, DataError.
    """
    from rotorrig.app.commands.simulate import SimulatedRig, faults_of, run_simulated_rig
    from rotorrig.app.commands.sweep import record_sweep
    from rotorrig.sims.plant import FaultSpec, draw, seal

    rig = rig_of(config)
    specs = faults_of(rig) + tuple(FaultSpec(name=n, parameters=dict(p)) for n, p in (faults or {}).items())
    with tempfile.TemporaryDirectory(prefix="rotorrig-truth-") as scratch:
        sealed = Path(scratch) / "truth.json"
        seal(draw(rig, seed=seed, faults=specs), sealed)
        simulation = SimulatedRig(seed=seed, hidden=sealed, rate=rate)
        with run_simulated_rig(rig, simulation, trial=trial) as ports:
            record_sweep(rig, out=Path(out), plan=plan, trial=trial, ports=ports, overwrite=overwrite)
    return Recording(out)


def _until(time_limit: str | None) -> Callable[[], bool]:
    if time_limit is None:
        return lambda: True
    seconds = read_quantity(time_limit, "time", where="time_limit", positive=True)
    end = time.monotonic() + seconds
    return lambda: time.monotonic() < end
