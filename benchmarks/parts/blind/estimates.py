"""Stiffness and unbalance as a diagnosis leaves them, with their sigmas, to be held against the truth."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from rotorrig.identify.base_fit import fit_base
from rotorrig.identify.extended_model import recordings_of
from rotorrig.processing import OrderTrackedResponse

Estimates = dict[str, tuple[float, float]]  # value and sigma, SI, by name


def is_judged(name: str) -> bool:
    """Return whether an estimate is a direct stiffness or the amount of an unbalance.

    >>> [is_judged(name) for name in ("kxx", "left kyy", "u", "u disk 2", "cxx", "phase")]
    [True, True, True, True, False, False]
    """
    words = name.split()
    return words[-1] in ("kxx", "kyy") or words[0] == "u"


def estimates(diagnosis: Mapping[str, Any], responses: Sequence[OrderTrackedResponse]) -> Estimates:
    """Return stiffness and unbalance of the final model: of the extended one, else of the base, fitted once more."""
    extended = diagnosis["gain"].get("base")
    found = (
        _of_base(responses) if extended is None else {n: (row["after"], row["sigma"]) for n, row in extended.items()}
    )
    return {name: pair for name, pair in found.items() if is_judged(name)}


def _of_base(responses: Sequence[OrderTrackedResponse]) -> Estimates:
    """Return the estimates of the base model in all recordings together, as the diagnosis fits it."""
    base = fit_base(recordings_of(responses))
    fit, names = base.polished, base.problem.parameters.base
    p = fit.p[: len(names)]
    values = names.values(p)
    sigmas = fit.sigma[names.sought] * names.space.slopes(values)
    found = {n: (float(v), float(s)) for n, v, s in zip(names.space.names, values, sigmas, strict=True)}
    spread, amounts = fit.sigma[names.unbalance].reshape(-1, 2), names.amounts(p)
    for i, (amount, plane) in enumerate(zip(names.space.amounts, names.space.planes, strict=True)):
        found[amount.name] = float(abs(amounts[plane])), float(np.hypot(*spread[i]) / np.sqrt(2))
    return found
