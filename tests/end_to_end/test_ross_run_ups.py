"""Run-ups that another program integrated in time: what is identified and named in them (tests/data/ross-run-ups).

Truths are those of make.py there. The tolerances are the fit's own standard deviations.
"""

import sys
from collections.abc import Callable, Collection
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from rotorrig.app import cli
from rotorrig.identify import base_fit
from rotorrig.identify.base_fit import AssessedFit
from rotorrig.identify.diagnosis import Diagnosis, diagnose
from rotorrig.identify.extended_model.tracked_recording import Recording
from rotorrig.identify.verdict.cross_validation import cross_validate
from rotorrig.identify.verdict.verdict import Verdict
from rotorrig.processing.files.response_mcap import read_response
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.config.units import RPM
from rotorrig.sims.effects.base import catalogue
from tests.identify.matched import taken_for_exact

ROOT = Path(__file__).parents[2]
DATA = ROOT / "tests/data/ross-run-ups"
CONFIG = ROOT / "configs/rk4.toml"
SPRING = {"kxx": 35.4e3, "kyy": 36.3e3, "cxx": 17.0, "cyy": 17.0}  # N/m, N s/m
UNBALANCE = 12e-6 * np.exp(1j * np.radians(40.0))  # kg m
BOW = 40e-6 * np.exp(1j * np.radians(-60.0))  # m, of a half-sine

Imported = Callable[..., OrderTrackedResponse]


@pytest.fixture(scope="module")
def imported(tmp_path_factory: pytest.TempPathFactory) -> Imported:
    """What `rotor import` makes of a table."""

    def read(name: str, mapping: str = "mapping") -> OrderTrackedResponse:
        out = tmp_path_factory.mktemp(name) / "response.mcap"
        words = ["rotor", "import", DATA / f"{name}.csv", "--config", CONFIG, "--vectors", DATA / f"{mapping}.toml"]
        with pytest.MonkeyPatch.context() as patch, pytest.raises(SystemExit) as ended:
            patch.setattr(sys, "argv", [*map(str, words), "--out", str(out)])
            cli.main()
        assert not ended.value.code
        return read_response(out)

    return read


@pytest.fixture(scope="module")
def healthy(imported: Imported) -> OrderTrackedResponse:
    return imported("healthy")


@pytest.fixture(scope="module")
def fit(healthy: OrderTrackedResponse) -> AssessedFit:
    return base_fit.fit_base([Recording(replace(healthy, rig=taken_for_exact(healthy.rig)))])


def judged(response: OrderTrackedResponse, *tried: str) -> Diagnosis:
    kinds: Collection[str] = {effect.name for effect in catalogue(response.rig)}
    assert set(tried) <= set(kinds)
    return diagnose([response], without=set(kinds) - set(tried))


def found_unbalance(fit: AssessedFit) -> tuple[complex, float]:
    """Return the unbalance on the disk and its standard deviation [kg m]."""
    names = fit.problem.parameters.base
    return complex(names.amounts(fit.polished.p[: len(names)])["disk"]), float(
        np.max(fit.polished.sigma[names.unbalance])
    )


def test_the_spring_and_the_unbalance_of_a_run_up_are_found(fit: AssessedFit) -> None:
    names = fit.problem.parameters.base
    values = names.values(fit.polished.p[: len(names)])
    sigmas = fit.polished.sigma[names.sought] * names.space.slopes(values)
    for name, value, sigma in zip(names.space.names, values, sigmas, strict=True):
        assert abs(value - SPRING[name]) < 3 * sigma < 0.15 * SPRING[name], name  # the config may be off by 1 mm
    unbalance, sigma = found_unbalance(fit)
    assert abs(unbalance - UNBALANCE) < 3 * sigma < 0.1 * abs(UNBALANCE)


@pytest.mark.campaign
def test_a_healthy_run_up_is_adequate(healthy: OrderTrackedResponse) -> None:
    found = judged(healthy, "bow", "runout", "coupling", "delay", "skew_stiffness")
    assert found.verdict is Verdict.ADEQUATE, found.sentence


@pytest.mark.campaign
def test_parallel_shafts_show_at_2x_whirling_backward_and_leave_the_fit_at_1x_alone(imported: Imported) -> None:
    fit = base_fit.fit_base([Recording(imported("parallel"))])
    assert not fit.adequacy.adequate
    first = fit.adequacy.misfits[0]
    assert first.order == 2
    assert first.speed_from * RPM < 1150 < first.speed_to * RPM  # half the critical speed
    assert first.backward > 0.9
    unbalance, sigma = found_unbalance(fit)
    assert abs(unbalance - UNBALANCE) < 3 * sigma < 0.2 * abs(UNBALANCE)


@pytest.mark.campaign
def test_a_crack_shows_at_the_harmonics_where_they_meet_the_critical_speed_along_the_sag(imported: Imported) -> None:
    fit = base_fit.fit_base([Recording(imported("crack"))])
    second = [misfit for misfit in fit.adequacy.misfits if misfit.order == 2]
    assert not fit.adequacy.adequate
    assert second[0].speed_from * RPM < 1150 < second[0].speed_to * RPM
    assert {second[0].probe, second[1].probe} == {"1y", "2y"}  # ROSS's weight acts along y, and so does its crack alone


@pytest.mark.campaign
def test_shafts_at_an_angle_show_at_3x_alone(imported: Imported) -> None:
    fit = base_fit.fit_base([Recording(imported("angular", "mapping-3x"))])
    loud = [misfit for misfit in fit.adequacy.misfits if misfit.sigma > fit.adequacy.limit]
    assert {misfit.order for misfit in loud} == {3.0}
    assert loud[0].speed_from * RPM < 765 < loud[0].speed_to * RPM  # a third of the critical speed


@pytest.mark.campaign
def test_taken_as_steady_a_healthy_run_up_is_wrong_and_its_times_put_it_right(
    healthy: OrderTrackedResponse, fit: AssessedFit
) -> None:
    still = base_fit.fit_base([Recording(healthy, swept=False)])
    assert not still.adequacy.adequate
    assert still.polished.chi2 > 5 * fit.polished.chi2
    assert cross_validate(fit.problem, fit.polished.p).over_floor < 1.2


@pytest.mark.campaign
def test_a_bow_is_named_and_gives_the_unbalance_back_what_that_had_absorbed(imported: Imported) -> None:
    found = judged(imported("bow"), "bow", "runout")
    assert found.verdict is Verdict.NAMED, found.sentence
    bow = found.causes[0]
    assert bow.label == "bow, even"
    size, angle = bow.parameters["bow"], bow.parameters["bow angle"]
    apart = abs(size.value * np.exp(1j * angle.value) - BOW)
    assert apart < 3 * size.sigma < 0.3 * abs(BOW)  # an arc stands for a half-sine, 3 % apart in the first mode
    assert found.gain is not None
    unbalance = found.gain.base["u"]
    assert abs(unbalance.before - abs(UNBALANCE)) > 5 * unbalance.sigma
    assert abs(unbalance.after - abs(UNBALANCE)) < 3 * unbalance.sigma
