"""`rotor sweep`: connect to motor and DAQ, run a plan, record it, stop the rotor."""

import shutil
from collections.abc import Callable, Sequence
from contextlib import ExitStack, suppress
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from threadpoolctl import threadpool_limits

from rotorrig.acquisition import Event
from rotorrig.acquisition.files import RecordingWriter
from rotorrig.acquisition.sweep import (
    Ask,
    Operator,
    RotorState,
    Step,
    SweepResult,
    plan_sweep,
    plan_timeline,
    reading_interval,
    run_sweep,
)
from rotorrig.app.commands.config_model import criticals_to_pass
from rotorrig.app.commands.simulate import SimulatedRig, run_simulated_rig
from rotorrig.app.commands.sweep_preview import estimate_bytes
from rotorrig.app.terminal import HINT, operator_for, progress_bars
from rotorrig.app.text import AS_STATED, AmplitudeUnit
from rotorrig.rig import ConfigError, DataError, Interlock, Provenance, code_version, connect
from rotorrig.rig.config import RPM, RigConfig
from rotorrig.rig.control import PATIENCE, PERSIST, GuardedControl
from rotorrig.rig.probes import DaqInfo
from rotorrig.sims.wire import BenchPorts

if TYPE_CHECKING:
    from rotorrig.app.viewer import LiveView

Progress = Callable[[Step, float, float], None]  # step, fraction of the sweep's steps, speed [rad/s]

SIMULATED_PATIENCE = 5.0  # s for the guardian of a simulated rig, which shares the processor with this program


def sweep(
    rig: RigConfig,
    *,
    out: Path,
    plan: str,
    trial: Sequence[str] = (),
    speeds: Sequence[float] = (),
    simulation: SimulatedRig | None,
    view: bool,
    unit: AmplitudeUnit = AS_STATED,
    yes: bool = False,
    overwrite: bool = False,
    rolling: bool = False,
    on_move: Callable[[Path], object] = lambda path: None,
    remark: str = "",
) -> SweepResult:
    """Run `rotor sweep`, on the config's devices or a simulated rig, with progress and, with `view`, the live view.

    A wrong plan or a full disk is refused before anything starts. With `yes`, requests to the operator do not wait.
    `on_move` is told where the recording goes on if its folder vanishes. `remark` is noted in it at its beginning. A
    stepped plan holds `speeds` [rad/s] instead of its own, if there are any; the view tells amplitudes in `unit`.
    """
    steps = steps_of(rig, plan, trial=trial, speeds=speeds)
    if simulation and any(isinstance(step, Ask) for step in steps):
        raise ConfigError(
            f"plan '{plan}': asks for trial masses to be mounted during the sweep, impossible on a simulated rig; "
            "want two sweeps, the second with --trial"
        )
    refuse_full_disk(out, rig, steps)
    with ExitStack() as stack:
        ports = stack.enter_context(run_simulated_rig(rig, simulation, trial=trial)) if simulation else None
        bars = stack.enter_context(progress_bars())
        say = partial(bars.console.print, markup=False, highlight=False, soft_wrap=True)
        operator = operator_for(steps, say=say, yes=yes)
        if bars.console.is_terminal:
            say(HINT)
        task = bars.add_task("sweeping", total=1.0, note="")

        def show(step: Step, fraction: float, speed: float) -> None:
            bars.update(task, completed=fraction, note=f"{speed * RPM:.0f} rpm")

        return record_sweep(
            rig,
            out=out,
            plan=plan,
            trial=trial,
            speeds=speeds,
            ports=ports,
            overwrite=overwrite,
            view=view,
            unit=unit,
            progress=show,
            operator=operator,
            rolling=rolling,
            on_move=on_move,
            remark=remark,
        )


def sweep_facts(result: SweepResult) -> dict[str, Any]:
    """Return the result of a sweep as plain values."""
    return {
        "seconds": result.seconds,
        "samples": result.samples,
        "gaps": result.gaps,
        "ending": result.ending,
        "trip": result.trip,
        "at_rest": result.state is RotorState.AT_REST,
        "rotor": result.state.value,
        "events": [{"t_s": event.t_ns / 1e9, "kind": event.kind, "text": event.text} for event in result.events],
    }


def steps_of(rig: RigConfig, plan: str, *, trial: Sequence[str] = (), speeds: Sequence[float] = ()) -> tuple[Step, ...]:
    """Return the steps of a plan, fast through critical speeds if the config says so. Raises ConfigError.

    A stepped plan holds `speeds` [rad/s] instead of its own, if there are any.
    """
    return plan_sweep(rig, plan, trial=trial, speeds=speeds, criticals=criticals_to_pass(rig))


def refuse_full_disk(out: Path, rig: RigConfig, steps: Sequence[Step]) -> None:
    """Raise DataError if the recording is unlikely to fit on its disk."""
    if rig.daq is None or not out.parent.is_dir():
        return  # reported by whoever opens them
    want = estimate_bytes(rig, plan_timeline(steps)[-1].end if steps else 0.0)
    free = shutil.disk_usage(out.parent).free
    if free < want:
        raise DataError(f"{out}: {free / 1e6:.0f} MB free, want {want / 1e6:.0f} MB for this sweep")


def record_sweep(
    rig: RigConfig,
    *,
    out: Path,
    plan: str = "default",
    trial: Sequence[str] = (),
    speeds: Sequence[float] = (),
    ports: BenchPorts | None = None,
    overwrite: bool = False,
    view: bool = False,
    unit: AmplitudeUnit = AS_STATED,
    progress: Progress | None = None,
    operator: Operator | None = None,
    on_move: Callable[[Path], object] = lambda path: None,
    remark: str = "",
    rolling: bool = False,
) -> SweepResult:
    """Run plan `plan` of the config and record it to `out`; `ports` replace the config's, for a simulated rig.

    `trial` are the trial masses on the rotor, such as "disk: 12 g mm at 90 deg"; they are noted in the recording. A
    stepped plan holds `speeds` [rad/s] instead of its own, if there are any. `view` is told in `unit`.
    However the sweep ends, the rotor is stopped and the recording closed. A rotor that turns before the start is a
    trip unless `rolling`. Raises ConfigError, LinkLost, LimitExceeded.
    """
    steps = steps_of(rig, plan, trial=trial, speeds=speeds)
    with ExitStack() as stack:
        # BLAS's own threads spin between the small products of every block, on a core that others need
        stack.enter_context(threadpool_limits(1, user_api="blas"))
        daq = stack.enter_context(connect.daq(rig, at=ports.daq if ports else None))
        info = daq.open()
        live = stack.enter_context(_live_view(rig, info, unit)) if view else None
        source = Provenance(
            config_hash=rig.hash, code_version=code_version(), source="simulated rig" if ports else rig.name
        )
        moved = partial(_tell_move, out, operator, on_move)
        writer = stack.enter_context(RecordingWriter(out, rig, info, source, overwrite=overwrite, on_move=moved))
        if remark:
            writer.write_event(Event(t_ns=0, kind="note", text=remark))
        control = GuardedControl(
            rig,
            log=out.with_name(f"{out.name}.guardian.txt"),
            at=ports.motor if ports else None,
            every=reading_interval(rig),
            patience=guardian_patience(rig, simulated=ports is not None),
            persist=SIMULATED_PATIENCE if ports else PERSIST,
        )
        stack.callback(control.close)
        drive = control.open()  # last: from here on its watchdog must be fed
        if operator and drive.watchdog is None:
            operator.tell("The drive has no watchdog: if this computer dies, only its own switch stops the rotor.")
        result = run_sweep(
            steps,
            control=control,
            daq=daq,
            rig=rig,
            writer=writer,
            interlock=Interlock(rig, info),
            listeners=[live.listen] if live else [],
            progress=progress,
            operator=operator,
            rolling=rolling,
            watchdog=drive.watchdog,
        )
    if live:
        live.sink.linger()
    return result


def _tell_move(out: Path, operator: Operator | None, on_move: Callable[[Path], object], path: Path) -> None:
    """Tell operator and caller where the recording goes on; called by the thread that writes it."""
    on_move(path)
    if operator:
        with suppress(OSError, ValueError):  # a terminal that is gone is no reason to end the recording
            operator.tell(f"{out}: the file or its folder has vanished; the recording goes on as {path}")


def guardian_patience(rig: RigConfig, *, simulated: bool) -> float:
    """Seconds without a processed sample after which the guardian stops the rotor."""
    if rig.motor and rig.motor.guardian:
        return rig.motor.guardian
    return SIMULATED_PATIENCE if simulated else PATIENCE


def _live_view(rig: RigConfig, info: DaqInfo, unit: AmplitudeUnit) -> "LiveView":
    from rotorrig.app.viewer import LiveView, serve  # Rerun takes a second to import

    return LiveView(rig, info, serve(), unit=unit)
