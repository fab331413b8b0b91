"""Loads and amounts in real halves, for a rotor whose response is linear in real amounts only (rotor/mirrored.py)."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from rotorrig.sims.rotor.loads import Load

Complex = NDArray[np.complex128]


def halved_loads(loads: Sequence[Load]) -> tuple[Load, ...]:
    """Return each load, then the same times j: those of the real and of the imaginary part of its amount."""
    return tuple(half for load in loads for half in (load, replace(load, pattern=1j * load.pattern)))


def halved_amounts(amounts: Complex) -> Complex:
    """Return the parts (..., 2 load) of amounts (..., load) in that order, real but for their type.

    >>> halved_amounts(np.array([3 + 4j, 1 - 2j])).real
    array([ 3.,  4.,  1., -2.])
    """
    parts = np.stack([amounts.real, amounts.imag], axis=-1).astype(complex)
    return parts.reshape(*amounts.shape[:-1], 2 * amounts.shape[-1])
