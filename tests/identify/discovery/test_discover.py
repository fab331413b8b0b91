"""A force that no known cause is, put into recordings by an effect of another file: place, law and prediction."""

from collections.abc import Sequence
from types import SimpleNamespace

import numpy as np
import pytest

from rotorrig.identify.base_fit import AssessedFit, fit_base
from rotorrig.identify.causes import Selection
from rotorrig.identify.discovery import Discovery, discover, force_search
from rotorrig.identify.extended_model.tracked_recording import recordings_of
from rotorrig.identify.least_squares import Stop
from rotorrig.identify.verdict import Unseen
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.effects.base import Effect, find
from tests.identify.matched import with_constant_damping
from tests.identify.swept import swept_response


def found_in(responses: Sequence[OrderTrackedResponse]) -> tuple[AssessedFit, Discovery | None]:
    base = fit_base(recordings_of(responses))
    none = Selection(start=base.problem, base=base.polished, steps=(), problem=base.problem, polished=base.polished)
    return base, discover(base, none, Unseen(base.problem, base.polished.p))


def hidden_at(rig: RigConfig, label: str, **theta: float) -> tuple[Effect, dict[str, float]]:
    effect = find(rig, label)
    return effect, effect.at_zero | {name.replace("_", " "): value for name, value in theta.items()}


@pytest.fixture(scope="module")
def driven(rig: RigConfig) -> tuple[AssessedFit, Discovery | None]:
    """The spring bearing pushes across the motion, as a fluid film does."""
    hidden = [hidden_at(rig, "skew_stiffness", k=1500.0)]
    constant, rng = with_constant_damping(rig), np.random.default_rng
    return found_in([swept_response(constant, hidden=hidden, rng=rng(5), trial=mass) for mass in (0j, 9e-6j)])


def test_what_drives_a_bearing_is_found_where_it_is_with_its_law(driven: tuple[AssessedFit, Discovery | None]) -> None:
    base, found = driven
    assert found is not None and not base.adequacy.adequate
    missing = found.missing
    assert (missing.kind, missing.laws, missing.shortfall) == ("force", ("cross-coupled stiffness",), "")
    assert missing.like == ("a fluid film",)
    assert missing.place == pytest.approx(0.481, abs=2.5 * missing.place_sigma)
    assert missing.place_sigma < 0.02
    assert "bearing spring is at 481 mm" in missing.words
    names = found.selection.problem.parameters
    stiffness = names.of_effect(found.selection.polished.p, len(names.effects) - 1)
    assert stiffness["cross-coupled stiffness"] == pytest.approx(1500.0, rel=0.1)


def test_its_place_has_a_probability_that_the_truth_is_within(driven: tuple[AssessedFit, Discovery | None]) -> None:
    missing = driven[1].missing  # type: ignore[union-attr]
    assert missing.probability.sum() == pytest.approx(1.0)
    mean = float(missing.places @ missing.probability)
    spread = float(np.sqrt((missing.places - mean) ** 2 @ missing.probability))
    assert mean == pytest.approx(0.481, abs=2.5 * spread)


def test_its_force_over_speed_supposes_no_law_and_follows_it(driven: tuple[AssessedFit, Discovery | None]) -> None:
    over = driven[1].missing.over_speed  # type: ignore[union-attr]
    assert over is not None
    true = 1500j * over.motion[:, 0]  # a quarter of a turn ahead of the motion
    loud = np.abs(true) > 5 * over.sigma[:, 0]
    assert loud.sum() > 3
    np.testing.assert_allclose(over.law[loud, 0], true[loud], rtol=0.2)
    assert np.median(np.abs(over.force - over.law)[loud, 0] / over.sigma[loud, 0]) < 3


def test_the_model_with_it_predicts_what_no_fit_saw(driven: tuple[AssessedFit, Discovery | None]) -> None:
    found = driven[1]
    assert found is not None
    assert found.predictions.after.over_expected < 1.5 < found.predictions.before.over_expected
    assert found.extended.adequacy.adequate


@pytest.mark.campaign
def test_an_unbalance_that_is_not_sought_may_be_a_couple_elsewhere_and_has_no_sure_place(rig: RigConfig) -> None:
    """With the disk's own unbalance sought either turns the rotor alike: both are told."""
    effect = find(rig, "unbalance_plane, at 400 mm")
    theta = effect.at_zero | {"unbalance re": 6e-6, "unbalance im": 3e-6, "shift": 0.02}
    rng = np.random.default_rng(5)
    _, found = found_in([swept_response(rig, hidden=[(effect, theta)], rng=rng, trial=m) for m in (0j, 9e-6j)])
    assert found is not None
    missing = found.missing
    told = " ".join([missing.words, *(rival.words for rival in missing.rivals)])
    assert "a force that turns with the shaft and grows with the square" in told
    assert "a moment that turns with the shaft and grows with the square" in told
    assert missing.shortfall.startswith("where it acts is not known")
    assert found.extended.adequacy.adequate
    assert missing.probability[np.abs(missing.places - 0.42) < 0.03].sum() > 0.1


@pytest.mark.campaign
@pytest.mark.parametrize("seed", [1, 2])
def test_a_pedestal_is_a_resonance_at_its_bearing(rig: RigConfig, seed: int) -> None:
    effect, theta = hidden_at(rig, "pedestal, x", lightness=0.3, omega=170.0, damping_ratio=0.05)
    _, found = found_in([swept_response(rig, hidden=[(effect, theta)], rng=np.random.default_rng(seed))])
    assert found is not None and found.missing.laws[0] == "resonance"
    assert found.missing.place == pytest.approx(0.481, abs=max(0.025, 2 * found.missing.place_sigma))
    assert "bearing spring" in found.missing.words


@pytest.mark.campaign
def test_a_probe_that_is_wrong_is_no_force(rig: RigConfig) -> None:
    hidden = [hidden_at(rig, "probe_angle, probe 2x", turn=0.12)]
    trials = (0j, 9e-6j)
    _, found = found_in([swept_response(rig, hidden=hidden, rng=np.random.default_rng(3), trial=m) for m in trials])
    assert found is not None and found.missing.kind == "reading"
    assert "2x" in found.missing.words
    assert (found.missing.over_speed, found.missing.places.size) == (None, 0)


def test_a_healthy_rig_lacks_nothing(healthy: OrderTrackedResponse) -> None:
    _, found = found_in([healthy])
    assert found is None or not found.missing.is_described


@pytest.mark.campaign
def test_a_force_that_the_config_has_is_not_found_by_that_name_again(rig: RigConfig) -> None:
    """A config tells two effects apart by their labels."""
    known = hidden_at(rig, "found_force, cross-coupled stiffness", place=0.481)
    base = fit_base(recordings_of([swept_response(rig, hidden=[hidden_at(rig, "skew_stiffness", k=1500.0)])]), [known])
    labels = [c.effect.label for c in force_search.search_force(base.problem, base.polished)]
    assert known[0].label in {effect.label for effect in base.problem.effects}
    assert known[0].label not in labels


def test_a_fit_that_ends_where_nothing_moves_stays_where_it_was(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = []

    def lost(found: object) -> object:  # as of a rotor that has no bounded motion further on
        asked.append(found)
        return found

    monkeypatch.setattr(force_search, "finish", lost)
    short = SimpleNamespace(polished=SimpleNamespace(stop=Stop.BUDGET))
    assert force_search._settle(short, lambda: True) is short  # type: ignore[arg-type]
    assert asked == [short], "and is not asked again"
