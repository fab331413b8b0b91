"""A sweep of the blind plant in this process: no wire, no file, otherwise what a rig would record."""

from collections.abc import Callable, Mapping
from dataclasses import replace

from rotorrig.acquisition import Event, RawRecording
from rotorrig.acquisition.sweep.plans import Coast, Dwell, Mark, Ramp, plan_sweep
from rotorrig.rig import Provenance, code_version
from rotorrig.rig.config import RigConfig
from rotorrig.rig.interlock.vibration import Vibration
from rotorrig.rig.probes import Block, DaqInfo
from rotorrig.sims.plant import FaultSpec, Plant, draw
from rotorrig.sims.plant.truth import Geometry, Noise, Unmodelled


def record(
    rig: RigConfig,
    *,
    seed: int,
    faults: tuple[FaultSpec, ...] = (),
    noise: Noise | None = None,
    trial: Mapping[str, tuple[float, float]] | None = None,
    run: int = 0,
    unmodelled: bool | Unmodelled = True,
    geometry: Geometry | None = None,
    guarded: bool = False,
) -> RawRecording:
    """Drive the plant of that seed through the config's default plan; `noise` other than a good rig's if given.

    `trial` masses, disk -> (kg m, rad), and the number of the `run` as in `truth.draw`: the same rig, other noise.
    Without `unmodelled` deviations it does nothing that its nameplate could not say; they are drawn unless they are
    given. `geometry` is how it was put together, if not as the nameplate says. Raises LimitExceeded, if `guarded`,
    where the interlock would have tripped.
    """
    truth = draw(rig, seed=seed, faults=faults, trial=trial, run=run, unmodelled=unmodelled is True)
    if isinstance(unmodelled, Unmodelled):
        truth = replace(truth, unmodelled=unmodelled)
    truth = replace(truth, noise=noise or truth.noise, geometry=geometry or truth.geometry)
    plant = Plant(rig, truth)
    info = DaqInfo(
        model="plant",
        serial=str(seed),
        sample_rate=plant.sample_rate,
        channels=plant.channels,
        volts_per_count=plant.volts_per_count,
        full_scale_counts=plant.full_scale_counts,
    )
    guard = Vibration(rig, info) if guarded else None
    events: list[Event] = []
    blocks: list[Block] = []

    def run_until(done: Callable[[], bool], limit: float) -> None:
        end = plant.t + limit
        while plant.t < end and not done():
            first = round(plant.t * plant.sample_rate)
            counts = plant.advance(min(plant.t + 0.1, end))
            if guard:
                guard.check(counts, speed=plant.speed, steady_speed=plant.speed)
            blocks.append(Block(counts=counts, first_sample=first, t_ns=round(first * 1e9 / plant.sample_rate)))

    for step in plan_sweep(rig):
        match step:
            case Mark(label=label):
                events.append(Event(t_ns=round(plant.t * 1e9), kind="mark", text=label))
            case Ramp(to=to, rate=rate):
                plant.command(to, rate, True)
                run_until(lambda to=to: abs(plant.speed - to) < 0.002 * to, 1000)
            case Dwell(seconds=seconds):
                run_until(lambda: False, seconds)
            case Coast(until=until):
                plant.command(0.0, 1.0, False)
                run_until(lambda until=until: plant.speed < until, 1000)
    source = Provenance(config_hash=rig.hash, code_version=code_version(), source=f"plant of seed {seed}, run {run}")
    return RawRecording(
        rig=rig, daq=info, blocks=tuple(blocks), events=tuple(events), motor=(), source=source, complete=True
    )
