"""The searches by name: "seed", the chapter's own, and "modern", the best made of its idea."""

from dataclasses import replace
from typing import Any, Literal

import numpy as np

from rotorrig.identify.chea.chapter import chapter
from rotorrig.identify.chea.engine import Engine
from rotorrig.identify.chea.modern import modern
from rotorrig.identify.chea.session import Evaluations, Record, Stop, StopReason

Profile = Literal["modern", "seed"]
Local = Literal["model", "sqp"]

#: name -> (dim, settings) -> Method, and its usual settings
_PROFILES: dict[str, tuple[Any, Any]] = {
    "modern": (modern.method, modern.MODERN),
    "seed": (chapter.method, chapter.SEED),
}


#: name -> where its search may end
_STOPS: dict[str, tuple[Stop, ...]] = {"modern": ("natural", "budget", "all"), "seed": ("natural",)}

#: name -> the profile whose local search it is
_LOCALS = {"model": "modern", "sqp": "seed"}


def begin(
    profile: str,
    settings: Any,
    dim: int,
    rng: np.random.Generator,
    *,
    local: str | None = None,
    stop: Stop = "natural",
) -> tuple[Record, Evaluations[StopReason]]:
    """Return an empty record and the search that fills it; `settings` and `local` None mean the profile's own.

    Raises ValueError for a name that is none of the two, the settings of the other, and a `stop` that is none or not of
    this profile.
    """
    if local is not None and local not in _LOCALS:
        raise ValueError(f"local is {local!r}, expected one of {', '.join(map(repr, _LOCALS))}")
    if profile not in _PROFILES:
        raise ValueError(f"profile is {profile!r}, expected one of {', '.join(map(repr, _PROFILES))}")
    if stop not in _STOPS[profile]:
        raise ValueError(f"stop is {stop!r}, expected {' or '.join(map(repr, _STOPS[profile]))} for {profile=}")
    method, usual = _PROFILES[profile]
    chosen = usual if settings is None else settings
    if type(chosen) is not type(usual):
        want = f"{type(usual).__module__}.{type(usual).__qualname__}"
        raise ValueError(f"settings is a {type(chosen).__name__}, expected a {want} for profile={profile!r}")
    parts = method(dim, chosen)
    if local is not None and _LOCALS[local] != profile:
        other, its_settings = _PROFILES[_LOCALS[local]]
        parts = replace(parts, local=other(dim, its_settings).local)
    record = Record(dim, same_point=chosen.same_point)
    return record, Engine(record, rng, parts).run(stop)
