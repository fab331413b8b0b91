"""Candidate effects for a set of recordings: the catalogue, adapted to the rig's scale, to orders and to times."""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.causes.settings import SELECTION
from rotorrig.identify.extended_model import Recording
from rotorrig.identify.measurement import SLOW_ROLL
from rotorrig.sims.effects import Effect, LineHum, RigScale, Stretch, UnbalanceStep, catalogue
from rotorrig.sims.rotor.model import ONE_RECORDING, between_recordings


def candidates(recordings: Sequence[Recording], *, without: Collection[str] = ()) -> list[Effect]:
    """Return every effect at every place and recording it could act in, less those named in `without`.

    Force laws are left out where a recording is of a rotor turning backwards: they are solved forwards alone. Hum is of
    the mains whose lines were found; of either where none was, and of none where nobody knows the times.
    """
    lawful = not any(recording.backward for recording in recordings)
    if all(np.isfinite(recording.response.compensation_omega) for recording in recordings):
        without = {*without, "slow_roll_subtracted"}  # the base model has it
    mains = {frequency for recording in recordings for frequency in recording.hum[1]}
    scale = scale_of(recordings)
    effects: list[Effect] = []
    for effect in catalogue(recordings[0].response.rig):
        if effect.name in without or ("force laws" in effect.acts_on and not lawful):
            continue
        able = effect.rescale(scale).within([float(order) for order in recordings[0].orders])
        if not able.parameters:
            continue
        if isinstance(able, UnbalanceStep):
            if (step := _with_grid(able, recordings)).grid:
                effects.append(step)
        elif isinstance(able, LineHum):
            if able.frequency in mains:
                effects.append(able.of_recordings(1 + max(r.number for r in recordings)))
        else:
            effects.append(able)
    return effects


def scale_of(recordings: Sequence[Recording]) -> RigScale:
    """Return the scale of the rig: how stiff its nameplate says it is, and how far it moved at 1X, at what speed."""
    sizes = [
        np.where(one.usable, np.maximum(np.abs(one.z), one.sigma), 0.0).max(axis=1)[:-1]
        for r in recordings
        for one in (r.measured[1],)
    ]
    largest = int(np.argmax([size.max() for size in sizes]))
    rows, size = recordings[largest].rows, sizes[largest]
    speed = recordings[largest].response.omega[rows][size.argmax()]
    return RigScale.of(recordings[0].response.rig, motion=float(size.max()), speed=float(speed))


def _with_grid(effect: UnbalanceStep, recordings: Sequence[Recording]) -> UnbalanceStep:
    """Return a step with its grid of times: before each recording but the first, within each whose times are known."""
    stretches: list[tuple[float, ...]] = []
    runs: list[Stretch] = []
    for r in recordings:
        if r.number:
            stretches.append((between_recordings(r.number),))
        begins = r.number * ONE_RECORDING
        own = [Stretch(run=name, t=begins + t, omega=omega) for name, t, omega in _timed_runs(r)]
        if own:
            t = np.sort(np.concatenate([run.t for run in own]))
            stretches.append(
                tuple(float(x) for x in np.unique(t[np.linspace(0, len(t) - 1, SELECTION.moments).astype(int)]))
            )
        runs += own
    return replace(effect, grid=tuple(stretches), runs=tuple(runs))


def _timed_runs(recording: Recording) -> Iterator[tuple[str, NDArray[np.float64], NDArray[np.float64]]]:
    """Yield name, times and speeds of every run but a slow roll; none where a time is not known."""
    response = recording.response
    for i, run in enumerate(response.runs):
        mine = response.run == i
        t = response.t[mine]
        if run.name != SLOW_ROLL and len(t) and np.isfinite(t).all():
            order = np.argsort(t)
            yield run.name, t[order], response.omega[mine][order]
