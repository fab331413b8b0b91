"""Probabilities of causes: they follow BIC, and sum to 1 among those that are tied."""

import dataclasses
import math

import pytest

from rotorrig.identify import Diagnosis, Verdict
from rotorrig.investigation.beliefs import NOTHING_KNOWN, NOTHING_MORE, beliefs


def test_tied_causes_share_by_their_evidence(named: Diagnosis) -> None:
    best = named.causes[0]
    rival = dataclasses.replace(best, label="a rival", evidence=best.evidence - 2 * math.log(3), chosen=False)
    tied = dataclasses.replace(named, verdict=Verdict.TIED, causes=(best, rival), tied=((best.label, rival.label),))
    held = {each.label: each.probability for each in beliefs(tied)}
    assert held == pytest.approx({best.label: 0.75, "a rival": 0.25})


def test_a_cause_that_stands_alone_is_believed(named: Diagnosis) -> None:
    alone = dataclasses.replace(named, causes=named.causes[:1], tied=())
    assert [(each.label, each.probability) for each in beliefs(alone)] == [(named.causes[0].label, 1.0)]


def test_where_nothing_is_in_the_model_the_config_has_its_share(good: Diagnosis, named: Diagnosis) -> None:
    assert beliefs(good)[0].label == NOTHING_MORE
    idle = dataclasses.replace(named.causes[0], chosen=False, evidence=-2 * math.log(9))
    held = beliefs(dataclasses.replace(named, verdict=Verdict.ADEQUATE, causes=(idle,)))
    assert [each.label for each in held] == [NOTHING_MORE, idle.label]
    assert held[0].probability == pytest.approx(0.9)


def test_what_is_not_explained_is_said(named: Diagnosis) -> None:
    assert [each.label for each in beliefs(dataclasses.replace(named, verdict=Verdict.UNEXPLAINED))] == [NOTHING_KNOWN]
