"""Run a sweep from a config: connect, record, stop, close, with the drivers a lab would use."""

from collections.abc import Callable, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING

from rotorrig.acquisition import plans
from rotorrig.acquisition.engine import SweepResult, run_sweep
from rotorrig.acquisition.mcap_file import RecordingWriter
from rotorrig.app.console import progress_bars
from rotorrig.app.simulating import StandIn, simulated
from rotorrig.rig import connect
from rotorrig.rig.clock import WallClock
from rotorrig.rig.description import RigConfig
from rotorrig.rig.interlock import Interlock
from rotorrig.rig.probes.base import DaqInfo
from rotorrig.rig.provenance import Provenance, code_version
from rotorrig.rig.units import RPM
from rotorrig.sims.wire.launch import BenchPorts

if TYPE_CHECKING:
    from rotorrig.app.viewer import LiveView

Progress = Callable[[plans.Step, float, float], None]  # step, fraction of the sweep's steps, speed [rad/s]


def sweep(
    rig: RigConfig, *, out: Path, plan: str, trial: Sequence[str] = (), stand_in: StandIn | None, view: bool
) -> SweepResult:
    """Run `rotor sweep`, on the config's devices or a simulated rig, with progress and, if wanted, the live view."""
    plans.steps(rig, plan, trial=trial)  # a wrong plan is said before anything starts
    with ExitStack() as stack:
        ports = stack.enter_context(simulated(rig, stand_in, trial=trial)) if stand_in else None
        bars = stack.enter_context(progress_bars())
        task = bars.add_task("sweeping", total=1.0, note="")

        def show(step: plans.Step, fraction: float, speed: float) -> None:
            bars.update(task, completed=fraction, note=f"{speed * RPM:.0f} rpm")

        return record_sweep(rig, out=out, plan=plan, trial=trial, ports=ports, view=view, progress=show)


def record_sweep(
    rig: RigConfig,
    *,
    out: Path,
    plan: str = "default",
    trial: Sequence[str] = (),
    ports: BenchPorts | None = None,
    overwrite: bool = False,
    view: bool = False,
    progress: Progress | None = None,
) -> SweepResult:
    """Run plan `plan` of the config and record it to `out`; `ports` replace the config's, for a simulated rig.

    `trial` are the trial masses on the rotor, such as "disk: 12 g mm at 90 deg"; the recording notes them.
    The rotor is stopped and the recording closed however it ends. Raises ConfigError, LinkLost, LimitExceeded.
    """
    steps = plans.steps(rig, plan, trial=trial)
    with ExitStack() as stack:
        motor = stack.enter_context(connect.motor(rig, port=ports.motor_port if ports else None))
        daq = stack.enter_context(connect.daq(rig, port=ports.daq_port if ports else None))
        motor.open()
        info = daq.open()
        live = stack.enter_context(_live_view(rig, info)) if view else None
        source = Provenance(
            config_hash=rig.hash, code_version=code_version(), source="simulated rig" if ports else rig.name
        )
        writer = stack.enter_context(RecordingWriter(out, rig, info, source, overwrite=overwrite))
        result = run_sweep(
            steps,
            motor=motor,
            daq=daq,
            rig=rig,
            writer=writer,
            interlock=Interlock(rig, info),
            listeners=[live.show] if live else [],
            progress=progress,
            clock=WallClock(),
        )
    if live:
        live.sink.linger()
    return result


def _live_view(rig: RigConfig, info: DaqInfo) -> "LiveView":
    from rotorrig.app.viewer import LiveView, serve  # Rerun takes a second to import

    return LiveView(rig, info, serve())
