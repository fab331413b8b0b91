"""The fit finds what the blind plant hides, with honest uncertainties, and says what it cannot tell.

The plant shares neither mesh, beam theory, time integration nor sensor code with the model that is fitted to it.
"""

import math
from dataclasses import replace

import numpy as np
import pytest

from rotorrig.identify.adequacy.residual_tests import assess
from rotorrig.identify.base_fit import fit_base
from rotorrig.identify.base_fit.fit import WHOLE, identify
from rotorrig.identify.extended_model.tracked_recording import recordings_of
from rotorrig.identify.identification import Identification
from rotorrig.identify.measurement import measure
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.errors import ConfigError, DataError
from rotorrig.sims.plant.draw import draw, expected_estimates
from tests.conftest import BLIND_SEED


@pytest.fixture(scope="module")
def found(blind_response: OrderTrackedResponse) -> Identification:
    return identify([blind_response], seed=0)


def test_the_plants_hidden_values_are_found_within_their_uncertainty(
    found: Identification, blind_response: OrderTrackedResponse
) -> None:
    rig = blind_response.rig
    truth = expected_estimates(rig, draw(rig, seed=BLIND_SEED))
    for name, value in truth.items():
        estimate = found.fits[0].estimate(name)
        off = math.remainder(estimate.value - value, math.tau) if name == "phase" else estimate.value - value
        assert abs(off) < 4 * estimate.sigma, f"{name}: {estimate.value:.6g} ± {estimate.sigma:.2g}, truth {value:.6g}"
        scale = 1.0 if name == "phase" else value
        #: half a per cent by which the model may be off is 4 % of damping
        assert estimate.sigma < 0.05 * scale, f"{name} is hardly known: ± {estimate.sigma / scale:.1%}"


def test_the_whole_sweep_comes_first_and_the_configs_bands_follow(found: Identification) -> None:
    assert [f.name for f in found.fits] == [WHOLE, "below critical"]
    low, high = found.fits[1].band
    assert low >= 480 * math.pi / 30
    assert high <= 2140 * math.pi / 30


def test_a_healthy_rig_is_adequate(blind_response: OrderTrackedResponse) -> None:
    adequacy = fit_base(recordings_of([blind_response])).adequacy
    assert adequacy.adequate
    assert adequacy.worst_sigma <= adequacy.limit


@pytest.mark.campaign
def test_a_model_without_the_moving_speed_is_called_wrong(blind_response: OrderTrackedResponse) -> None:
    untimed = replace(blind_response, keyphasor_t=np.empty(0))
    found = identify([untimed])
    whole = found.fits[0]
    adequacy = assess(untimed, {1: whole.prediction})
    assert not adequacy.adequate
    assert any("steady" in words for words in whole.words)


def test_a_vector_added_in_a_narrow_band_is_located(
    found: Identification, blind_response: OrderTrackedResponse
) -> None:
    z = blind_response.z.copy()
    up = blind_response.run == 1
    rpm = blind_response.omega * 30 / np.pi
    odd = up & (rpm > 1400) & (rpm < 1600)
    z[odd, 2, blind_response.orders.index(2.0)] += 10e-6
    whole = found.fits[0]
    adequacy = assess(replace(blind_response, z=z), {1: whole.prediction})
    worst = adequacy.misfits[0]
    assert not adequacy.adequate
    assert (worst.run, worst.probe, worst.order) == ("up", "2x", 2.0)
    assert worst.sigma > adequacy.limit
    assert 1300 < worst.speed_from * 30 / math.pi < 1450
    assert 1550 < worst.speed_to * 30 / math.pi < 1700
    assert worst.residual == pytest.approx(10e-6, rel=0.3)


@pytest.mark.campaign
def test_one_probe_alone_leaves_the_other_direction_undetermined(blind_response: OrderTrackedResponse) -> None:
    usable = blind_response.usable.copy()
    usable[:, [1, 2, 3]] = False
    sought = blind_response.rig.identify
    assert sought is not None
    rig = blind_response.rig.model_copy(update={"identify": sought.model_copy(update={"bands": {}})})
    alone = identify([replace(blind_response, rig=rig, usable=usable)]).fits[0]
    assert alone.estimate("kxx").determined
    assert not alone.estimate("cyy").determined
    assert math.isinf(alone.estimate("cyy").sigma)
    assert not alone.estimate("kyy").determined
    assert any(words.startswith("No probe looks along y") for words in alone.words)


@pytest.mark.campaign
def test_a_band_the_data_do_not_reach_is_left_out_and_said(blind_response: OrderTrackedResponse) -> None:
    sought = blind_response.rig.identify
    assert sought is not None
    beyond = sought.model_copy(update={"bands": {"overspeed": (1000.0, 2000.0)}})
    found = identify([replace(blind_response, rig=blind_response.rig.model_copy(update={"identify": beyond}))])
    assert [f.name for f in found.fits] == [WHOLE]
    assert any("The band 'overspeed' was left out: " in words for words in found.fits[0].words)


def test_an_objective_on_amplitudes_refuses_runs_with_trial_masses_alone(blind_response: OrderTrackedResponse) -> None:
    runs = tuple(replace(run, trial_unbalance={"disk": 12e-6 + 0j}) for run in blind_response.runs)
    with pytest.raises(DataError, match="every run carries a trial mass, want one without"):
        identify([replace(blind_response, runs=runs)], objective="f2")


def test_too_few_rows_are_refused(blind_response: OrderTrackedResponse) -> None:
    with pytest.raises(DataError, match="0 usable rows between 95493 and 114592 rpm, want at least 5"):
        measure(blind_response, band=(10000.0, 12000.0))


def test_a_rig_without_an_identify_table_is_refused(blind_response: OrderTrackedResponse) -> None:
    rig = blind_response.rig.model_copy(update={"identify": None})
    with pytest.raises(ConfigError, match=r"no \[identify\] section"):
        identify([replace(blind_response, rig=rig)])
