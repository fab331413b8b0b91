"""`rotor demo`: sweep, track, identify, diagnose and report a simulated RK4, healthy and with a bent shaft."""

import math
import time
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from rich.progress import Progress

from rotorrig.acquisition.files import part_path, read_recording
from rotorrig.acquisition.sweep import Step
from rotorrig.app.commands import diagnose
from rotorrig.app.commands.sweep import record_sweep
from rotorrig.app.report import write_report
from rotorrig.app.terminal import operator_for, progress_bars, tables
from rotorrig.app.terminal import out as console
from rotorrig.app.viewer import write_result_rrd
from rotorrig.identify import Diagnosis, Identification, identify, write_diagnosis, write_identification
from rotorrig.processing import OrderTrackedResponse, track
from rotorrig.processing.files import read_response, write_response
from rotorrig.rig import write_whole_text
from rotorrig.rig.config import RPM, RigConfig
from rotorrig.sims.plant import FaultSpec, Truth, draw, expected_estimates, seal, unseal
from rotorrig.sims.wire import simulated_bench

SEALED = "truth.sealed.json"


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """One demo run: folder, seed of the hidden truth and faults of the rig."""

    folder: str
    title: str
    seed: int
    faults: tuple[FaultSpec, ...]


def cases(seed: int) -> tuple[Case, ...]:
    """Return the healthy run and the one with a bent shaft; `seed` draws their hidden truth."""
    return (
        Case(folder="", title="healthy rig", seed=seed, faults=()),
        Case(
            folder="bowed",
            title="rig with a bent shaft",
            seed=seed + 1,
            faults=(FaultSpec(name="bow", parameters={"amount": 20e-6, "angle": math.radians(110.0)}),),
        ),
    )


def files_in(out: Path) -> dict[Path, str]:
    """Return every file that `run_demo` writes into a folder, and its kind."""
    kinds = {
        SEALED: "truth",
        "run.mcap": "run",
        "response.mcap": "response",
        "fit.json": "fit",
        "diagnosis.json": "diagnosis",
        "report.html": "report",
        "demo.rrd": "rrd",
        "extended.toml": "config",
        "diagnosis-extended.json": "diagnosis",
    }
    return {out / case.folder / name: kind for case in cases(0) for name, kind in kinds.items()}


def run_demo(rig: RigConfig, *, out: Path, seed: int = 1, rate: float = 20.0) -> None:
    """Run both cases into `out` and print the results; `rate` is simulated seconds per second, at most."""
    began = time.perf_counter()
    for case in cases(seed):
        folder = out / case.folder
        folder.mkdir(parents=True, exist_ok=True)
        console.rule(case.title)
        identification, diagnosis = _run_case(rig, case, folder, rate)
        truth = unseal(folder / SEALED)  # only now: diagnosis.json is written
        _report(rig, folder, identification, diagnosis, truth)
        extend(rig, case, folder, diagnosis)
    console.rule()
    console.print(
        f"Done in {time.perf_counter() - began:.0f} s. "
        f"Open {out / 'report.html'} and {out / 'bowed/report.html'}; "
        f"rotor view {out / 'demo.rrd'} shows the result in the Rerun viewer."
    )


def _run_case(rig: RigConfig, case: Case, folder: Path, rate: float) -> tuple[Identification, Diagnosis]:
    seal(draw(rig, seed=case.seed, faults=case.faults), folder / SEALED)
    with progress_bars() as bars:
        _sweep(rig, folder, case, rate, bars)
        task = bars.add_task("tracking 1X", total=1.0, note="")
        recording = read_recording(folder / "run.mcap")
        response = track(recording, progress=lambda done: bars.update(task, completed=done))
        write_response(folder / "response.mcap", response)
        bars.update(task, completed=1.0)
        task = bars.add_task("identifying (CHEA)", total=None, note="")
        identification = identify([response], seed=case.seed, progress=lambda text: bars.update(task, note=text))
        write_identification(folder / "fit.json", identification)
        bars.update(task, total=1.0, completed=1.0, note="")
    diagnosis = diagnose.diagnose_responses([response], seed=case.seed)
    write_diagnosis(folder / "diagnosis.json", diagnosis)
    return identification, diagnosis


def extend(rig: RigConfig, case: Case, folder: Path, diagnosis: Diagnosis) -> None:
    """Extend the config by the named cause, if any, and diagnose the run again with it."""
    extended = diagnose.extend_rig(rig, diagnosis)
    if extended is None:
        return
    write_whole_text(folder / "extended.toml", extended.text)
    response = diagnose.with_model_of(read_response(folder / "response.mcap"), extended)
    again = diagnose.diagnose_responses([response], seed=case.seed)
    write_diagnosis(folder / "diagnosis-extended.json", again)
    console.print(
        f"With {'; '.join(effect.label for effect in extended.effects)} in the model ({folder}/extended.toml):"
    )
    diagnose.show(again)


def _sweep(rig: RigConfig, folder: Path, case: Case, rate: float, bars: Progress) -> None:
    task = bars.add_task("starting the rig", total=1.0, note="")

    def show(step: Step, fraction: float, speed: float) -> None:
        bars.update(task, completed=fraction, note=f"{speed * RPM:.0f} rpm")

    say = partial(bars.console.print, markup=False, highlight=False, soft_wrap=True)
    part_path(folder / "run.mcap").unlink(missing_ok=True)  # of a demo that was killed: it can be made again
    with simulated_bench(rig.text, seed=case.seed, hidden=folder / SEALED, rate=rate) as ports:
        bars.update(task, description="sweeping")
        operator = operator_for((), say=say, yes=True)
        result = record_sweep(
            rig, out=folder / "run.mcap", ports=ports, overwrite=True, progress=show, operator=operator
        )
    bars.update(task, completed=1.0, note=f"{result.seconds:.0f} s recorded")


def _report(rig: RigConfig, folder: Path, identification: Identification, diagnosis: Diagnosis, truth: Truth) -> None:
    response: OrderTrackedResponse = read_response(folder / "response.mcap")
    actual = expected_estimates(rig, truth)
    recording = read_recording(folder / "run.mcap")
    write_report(
        folder / "report.html",
        response=response,
        identification=identification,
        diagnosis=diagnosis,
        truth=actual,
        recording=recording,
    )
    write_result_rrd(folder / "demo.rrd", response, identification, diagnosis, recording=recording)
    console.print(tables.identification_table(identification, actual))
    diagnose.show(diagnosis)
