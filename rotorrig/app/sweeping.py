"""Run a sweep from a config: connect, record, stop, close, with the drivers a lab would use."""

from collections.abc import Callable, Sequence
from contextlib import ExitStack
from pathlib import Path

from rotorrig.acquisition import plans
from rotorrig.acquisition.engine import SweepResult, run_sweep
from rotorrig.acquisition.mcap_file import RecordingWriter
from rotorrig.app.console import progress_bars
from rotorrig.rig import connect
from rotorrig.rig.clock import WallClock
from rotorrig.rig.description import RigConfig
from rotorrig.rig.interlock import Interlock
from rotorrig.rig.probes.base import Block
from rotorrig.rig.provenance import Provenance, code_version
from rotorrig.sims.wire.launch import BenchPorts, simulated_bench

Progress = Callable[[plans.Step, float, float], None]  # step, fraction of the sweep's steps, speed [rad/s]


def sweep(rig: RigConfig, *, out: Path, plan: str, seed: int | None, rate: float, view: bool) -> SweepResult:
    """Run `rotor sweep`: with a `seed` on a simulated rig, otherwise on the config's devices; live view if wanted."""
    with ExitStack() as stack:
        ports = None if seed is None else stack.enter_context(simulated_bench(rig.text, seed=seed, rate=rate))
        listeners = [stack.enter_context(live_view(rig))] if view else []
        bars = stack.enter_context(progress_bars())
        task = bars.add_task("sweeping", total=1.0, note="")

        def show(step: plans.Step, fraction: float, speed: float) -> None:
            bars.update(task, completed=fraction, note=f"{speed * plans.RPM:.0f} rpm")

        return record_sweep(rig, out=out, plan=plan, ports=ports, listeners=listeners, progress=show)


def record_sweep(
    rig: RigConfig,
    *,
    out: Path,
    plan: str = "default",
    ports: BenchPorts | None = None,
    listeners: Sequence[Callable[[Block], None]] = (),
    progress: Progress | None = None,
) -> SweepResult:
    """Run plan `plan` of the config and record it to `out`; `ports` replace the config's, for a simulated rig.

    The rotor is stopped and the recording closed however it ends. Raises ConfigError, LinkLost, LimitExceeded.
    """
    steps = plans.steps(rig, plan)
    with ExitStack() as stack:
        motor = stack.enter_context(connect.motor(rig, port=ports.motor_port if ports else None))
        daq = stack.enter_context(connect.daq(rig, port=ports.daq_port if ports else None))
        motor.open()
        info = daq.open()
        source = Provenance(
            config_hash=rig.hash, code_version=code_version(), source="simulated rig" if ports else rig.name
        )
        writer = stack.enter_context(RecordingWriter(out, rig, info, source))
        return run_sweep(
            steps,
            motor=motor,
            daq=daq,
            rig=rig,
            writer=writer,
            interlock=Interlock(rig, info),
            listeners=listeners,
            progress=progress,
            clock=WallClock(),
        )
