"""Several recordings of one rig are identified together: a trial mass tells what one recording alone cannot."""

from dataclasses import replace

import numpy as np
import pytest

from rotorrig.identify.base_fit.fit import identify
from rotorrig.identify.identification import Identification
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.config.extension import Extension
from rotorrig.rig.errors import DataError
from rotorrig.sims.effects.base import find
from tests.identify.matched import taken_for_exact
from tests.identify.swept import C, K, U, swept_response

GAIN = 1.02  # of all probes: alone, a recording takes that for a larger unbalance


@pytest.fixture(scope="module")
def pair(rig: RigConfig) -> list[OrderTrackedResponse]:
    rng = np.random.default_rng(11)
    made = [swept_response(rig, rng=rng, orders=(1,), trial=trial) for trial in (0j, 12e-6j)]
    return [
        replace(r, z=GAIN * r.z, slow_roll=GAIN * r.slow_roll, source=replace(r.source, source_hash=f"{i:016x}"))
        for i, r in enumerate(made)
    ]


@pytest.fixture(scope="module")
def both(pair: list[OrderTrackedResponse]) -> Identification:
    return identify(pair)


def test_a_known_trial_mass_tells_the_gain_of_the_probes_from_the_unbalance(
    pair: list[OrderTrackedResponse], both: Identification
) -> None:
    alone = identify(pair[:1]).fits[0].estimate("u")
    together = both.fits[0].estimate("u")
    assert together.sigma < 0.6 * alone.sigma
    assert abs(together.value - abs(U)) < 3 * together.sigma
    for name, value in zip(("kxx", "kyy", "cxx", "cyy"), (*K, *C), strict=True):
        found = both.fits[0].estimate(name)
        assert abs(found.value - value) < 4 * found.sigma


def test_the_prediction_has_the_rows_of_all_responses_in_their_order(
    pair: list[OrderTrackedResponse], both: Identification
) -> None:
    assert both.responses == tuple((r.source.source_hash, len(r.omega)) for r in pair)
    measured = np.concatenate([r.z[..., 0] for r in pair])
    off = np.abs(both.fits[0].prediction - measured)
    assert np.nanmax(off) < 3e-6
    first = len(pair[0].omega)
    assert np.nanmax(np.abs(both.fits[0].prediction[:first] - measured[first : 2 * first])) > 20e-6


@pytest.mark.campaign
def test_effects_of_the_config_are_in_the_model(rig: RigConfig) -> None:
    skew = find(rig, "skew_stiffness")
    (unknown,) = skew.parameters
    theta = {unknown.name: 2 * unknown.size}
    exact = taken_for_exact(rig)
    made = swept_response(exact, rng=np.random.default_rng(4), hidden=[(skew, theta)], orders=(1,))
    known = exact.model_copy(update={"effects": (Extension(name="skew_stiffness", parameters=theta),)})
    plain, extended = (identify([replace(made, rig=config)]) for config in (exact, known))
    assert extended.effects == ("skew_stiffness",)
    assert plain.effects == ()
    assert plain.fits[0].chi2 > 3 * extended.fits[0].chi2
    found = next(e for e in extended.fits[0].nuisances if e.name.startswith("skew_stiffness: "))
    assert found.unit == unknown.unit
    assert abs(found.value - 2 * unknown.size) < 4 * found.sigma


def test_responses_of_other_probes_are_refused(pair: list[OrderTrackedResponse]) -> None:
    renamed = replace(pair[1], probes=("a", *pair[1].probes[1:]))
    with pytest.raises(DataError, match="response 2: has the probes"):
        identify([pair[0], renamed])
    with pytest.raises(DataError, match="no response was given"):
        identify([])
