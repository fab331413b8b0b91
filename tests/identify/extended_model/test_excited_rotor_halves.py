"""Loads and amounts in real halves."""

import numpy as np

from rotorrig.identify.extended_model.excited_rotor import halved_amounts, halved_loads
from rotorrig.sims.rotor.model.loads import Load


def test_halves_times_their_amounts_are_the_whole(rng: np.random.Generator) -> None:
    patterns, amounts = rng.normal(size=(2, 3, 4)) + 1j * rng.normal(size=(2, 3, 4))
    loads = [Load(pattern, "unbalance", since=2.0) for pattern in patterns]
    halves = halved_loads(loads)
    parts = halved_amounts(amounts.T)  # (row, half)
    assert not parts.imag.any()
    assert {(half.law, half.since) for half in halves} == {("unbalance", 2.0)}
    np.testing.assert_allclose(parts @ np.array([half.pattern for half in halves]), amounts.T @ patterns, atol=1e-12)
