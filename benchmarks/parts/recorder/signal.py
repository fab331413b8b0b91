"""The samples of the recorder's benchmark: a simulated RK4 at rest and at speed, once round, and as it stops."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchmarks.parts.recorder.rig import FRAME_SCANS, SPEED
from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant import Plant, draw

LOUD = 1.5  # times the limit, of the vibration that is to trip it
SETTLE_SECONDS, LOOP_TURNS, REST_SECONDS = 3.0, 100, 1.0
STOP_SECONDS = 1.5  # from speed to rest


def write_signal(path: Path, rig: RigConfig) -> None:
    """Compute what the simulated rig's DAQ sends at rest, at speed, once round, and in a stop; write it to `path`."""
    plant = Plant(rig, draw(rig, seed=1))
    assert rig.keyphasor and rig.limits
    rest = plant.advance(REST_SECONDS)
    plant.command(SPEED, 1000.0, True)
    plant.advance(plant.t + SETTLE_SECONDS)
    running = _whole_turns(plant.advance(plant.t + LOOP_TURNS * 2 * np.pi / SPEED * 1.05), rig.keyphasor.channel)
    loud = running.astype(float)
    turn = 2 * np.pi * LOOP_TURNS * np.arange(len(running)) / len(running)
    for probe in rig.probes:
        volts = LOUD * rig.limits.vibration * probe.sensitivity * np.cos(turn)
        loud[:, probe.channel] += volts / plant.volts_per_count[probe.channel]
    plant.command(0.0, SPEED / STOP_SECONDS, True)
    stopping = plant.advance(plant.t + STOP_SECONDS + 0.1)
    whole = len(stopping) // FRAME_SCANS * FRAME_SCANS
    np.savez(path, rest=rest, running=running, loud=np.round(loud).astype(np.int32), stopping=stopping[:whole])


def _whole_turns(counts: NDArray[np.int32], channel: int) -> NDArray[np.int32]:
    """Return the stretch from the first falling keyphasor edge to the one `LOOP_TURNS` later, so that it goes round."""
    pulse = counts[:, channel]
    low = pulse < (pulse.min() + pulse.max()) / 2
    edges = np.flatnonzero(~low[:-1] & low[1:]) + 1
    return counts[edges[0] : edges[LOOP_TURNS]]
