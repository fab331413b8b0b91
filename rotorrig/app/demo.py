"""`rotor demo`: the whole path, from the wire to a report, on a simulated RK4; twice, the second time misaligned."""

import time
from dataclasses import dataclass
from pathlib import Path

from rich.progress import Progress

from rotorrig.acquisition.mcap_file import read_recording
from rotorrig.acquisition.plans import Step
from rotorrig.app import tables
from rotorrig.app.console import out as console
from rotorrig.app.console import progress_bars
from rotorrig.app.report import write_report
from rotorrig.app.sweeping import record_sweep
from rotorrig.app.viewer import write_result_rrd
from rotorrig.identify.diagnosis import Diagnosis, Verdict, diagnose
from rotorrig.identify.fit import fit
from rotorrig.identify.identification import Identification
from rotorrig.identify.result_files import write_diagnosis, write_identification
from rotorrig.processing.pipeline import track
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.processing.response_file import read_response, write_response
from rotorrig.rig.description import RigConfig
from rotorrig.rig.units import RPM
from rotorrig.sims.plant.truth import FaultSpec, Truth, draw, identified_truth, seal, unseal
from rotorrig.sims.wire.launch import simulated_bench

SEALED = "truth.sealed.json"


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """One demo run: its folder, the seed of its hidden deviations and what is wrong with the rig."""

    folder: str
    title: str
    seed: int
    faults: tuple[FaultSpec, ...]


def cases(seed: int) -> tuple[Case, ...]:
    """Return the healthy run and the one with a misaligned coupling; `seed` draws what each rig hides."""
    return (
        Case(folder="", title="healthy rig", seed=seed, faults=()),
        Case(
            folder="misaligned",
            title="rig with a misaligned coupling",
            seed=seed + 1,
            faults=(FaultSpec(name="coupling", parameters={}),),
        ),
    )


def run_demo(rig: RigConfig, *, out: Path, seed: int = 1, rate: float = 20.0) -> None:
    """Run both cases into `out` and print what came of them; `rate` is simulated seconds per second, at the most."""
    began = time.perf_counter()
    for case in cases(seed):
        folder = out / case.folder
        folder.mkdir(parents=True, exist_ok=True)
        console.rule(case.title)
        found, diagnosis = _run_case(rig, case, folder, rate)
        truth = unseal(folder / SEALED)  # only now: diagnosis.json is written
        _report(rig, folder, found, diagnosis, truth)
    console.rule()
    console.print(
        f"Done in {time.perf_counter() - began:.0f} s. "
        f"Open {out / 'report.html'} and {out / 'misaligned/report.html'}; "
        f"rotor view {out / 'demo.rrd'} shows orbits and Bode plots."
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
        found = fit(response, seed=case.seed, progress=lambda text: bars.update(task, note=text))
        write_identification(folder / "fit.json", found)
        diagnosis = diagnose(response, found)
        write_diagnosis(folder / "diagnosis.json", diagnosis)
        bars.update(task, total=1.0, completed=1.0, note="")
    return found, diagnosis


def _sweep(rig: RigConfig, folder: Path, case: Case, rate: float, bars: Progress) -> None:
    task = bars.add_task("starting the rig", total=1.0, note="")

    def show(step: Step, fraction: float, speed: float) -> None:
        bars.update(task, completed=fraction, note=f"{speed * RPM:.0f} rpm")

    with simulated_bench(rig.text, seed=case.seed, hidden=folder / SEALED, rate=rate) as ports:
        bars.update(task, description="sweeping")
        result = record_sweep(rig, out=folder / "run.mcap", ports=ports, overwrite=True, progress=show)
    bars.update(task, completed=1.0, note=f"{result.seconds:.0f} s recorded")


def _report(rig: RigConfig, folder: Path, found: Identification, diagnosis: Diagnosis, truth: Truth) -> None:
    response: OrderTrackedResponse = read_response(folder / "response.mcap")
    actual = identified_truth(rig, truth)
    write_report(folder / "report.html", response=response, identification=found, diagnosis=diagnosis, truth=actual)
    recording = read_recording(folder / "run.mcap")
    write_result_rrd(folder / "demo.rrd", response, found, diagnosis, recording=recording)
    console.print(tables.identified(found, actual))
    style = "green" if diagnosis.verdict is Verdict.ADEQUATE else "yellow"
    console.print(diagnosis.sentence, style=style)
