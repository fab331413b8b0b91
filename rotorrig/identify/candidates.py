"""The causes worth a try for a set of recordings: the catalogue, made to fit what was recorded."""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace

import numpy as np

from rotorrig.identify.measurement import SLOW_ROLL
from rotorrig.identify.recording import Recording
from rotorrig.rig.description import RigConfig
from rotorrig.sims.effects.base import Effect, Parameter, catalogue
from rotorrig.sims.effects.internal_damping import InternalDamping
from rotorrig.sims.effects.unbalance_step import UnbalanceStep

BEFORE = -1e6  # s: before any recording


def candidates(recordings: Sequence[Recording], *, without: Collection[str] = ()) -> list[Effect]:
    """Return every effect at every place and recording it could act in, less those named in `without`."""
    found: list[Effect] = []
    for effect in catalogue(recordings[0].response.rig):
        if effect.name in without:
            continue
        able = effect.within([float(order) for order in recordings[0].orders])
        if not able.parameters:
            continue
        if isinstance(able, UnbalanceStep):
            found += _steps(able, recordings)
        elif able.per_recording and len(recordings) > 1:
            found += [
                replace(able, recording=r.number, where=_joined(able.where, f"recording {r.number + 1}"))
                for r in recordings
            ]
        else:
            found.append(able)
    return found


def background(rig: RigConfig) -> list[Effect]:
    """Return the effects that every rig has a little of, nuisances of the base with priors: damping in the shaft."""
    return [
        replace(effect, parameters=tuple(replace(q, prior=rig.prior.rotating_damping) for q in effect.parameters))
        for effect in catalogue(rig)
        if isinstance(effect, InternalDamping)
    ]


def _steps(effect: UnbalanceStep, recordings: Sequence[Recording]) -> Iterator[Effect]:
    """Yield a step at the start of every run but the first, and one before every recording but the first."""
    for r in recordings:
        if r.number:
            yield _at(effect, r, BEFORE, f"before recording {r.number + 1}")
        begun: list[str] = []
        for i, run in enumerate(r.response.runs):
            t = r.response.t[r.response.run == i]
            if run.name == SLOW_ROLL or not len(t) or not np.isfinite(t).all():
                continue
            if begun:
                suffix = f" of recording {r.number + 1}" if len(recordings) > 1 else ""
                yield _at(effect, r, float(t.min()), f"from run '{run.name}'{suffix} on")
            begun.append(run.name)


def _at(effect: UnbalanceStep, recording: Recording, time: float, where: str) -> Effect:
    fixed = Parameter(name="time", unit="s", low=time, high=time, size=1.0, nothing=time)
    parameters = tuple(fixed if p.name == "time" else p for p in effect.parameters)
    return replace(effect, parameters=parameters, recording=recording.number, where=_joined(effect.where, where))


def _joined(*parts: str) -> str:
    return ", ".join(part for part in parts if part)
