"""The nameplate among the causes: verdicts, ties and ranks of findings whose figures are given."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from rotorrig.identify.adequacy import Adequacy
from rotorrig.identify.base_fit import assess_fit
from rotorrig.identify.identification import Deviation, NameplateCheck, NameplateFinding
from rotorrig.identify.verdict import nameplate
from rotorrig.identify.verdict.nameplate import (
    NameplateSelection,
    conclude_with_nameplate,
    effect_ties,
    find_implausible,
    nameplate_ties,
    rank_with_nameplate,
    select_beside_nameplate,
)
from rotorrig.identify.verdict.sentences import with_nameplate
from rotorrig.identify.verdict.verdict import Verdict
from rotorrig.processing.response import OrderTrackedResponse
from tests.identify.problems import problem_of
from tests.identify.verdict.test_sentences import BOW, RIGHT, WRONG, said
from tests.identify.verdict.test_verdict import ALONE, BEND, LUMP, NONE, Tried, selection


def deviation(kind: str, where: str, *, evidence: float = 15.0) -> Deviation:
    return Deviation(
        kind=kind,
        where=where,
        title=f"{kind} of {where}",
        words=f"{where} is 3.0 ± 0.5 mm off",
        value=3e-3,
        sigma=5e-4,
        unit="m",
        nameplate=0.48,
        nameplate_unit="m",
        pull=5.0,
        evidence=evidence,
        nuisances=(f"position {where}",),
    )


SPRING, DISK = deviation("bearing_position", "spring"), deviation("disk_position", "disk", evidence=9.0)


def finding(sigmas: float, *alternatives: Deviation) -> NameplateFinding:
    return NameplateFinding(group="positions", sigmas=sigmas, deviation=SPRING, alternatives=alternatives)


def selected(steps: Any = NONE, *, widened: tuple[str, ...] = (), **more: Any) -> NameplateSelection:
    model = SimpleNamespace(widened=frozenset(widened))
    start = cast(Any, SimpleNamespace(problem=SimpleNamespace(model=model)))
    return NameplateSelection(base=start, start=start, selection=steps, **more)


def test_the_search_begins_anew_from_a_better_base(monkeypatch: pytest.MonkeyPatch) -> None:
    fits = SimpleNamespace(problem="", polished="poor"), SimpleNamespace(problem="", polished="better")
    for fit in fits:
        fit.adequacy = SimpleNamespace(adequate=True)
    poor, better = cast(Any, fits)
    lower = SimpleNamespace(p="lower")
    searched = []

    def search(problem: Any, base: Any, known: Any, **how: Any) -> Any:
        searched.append(base)
        return SimpleNamespace(base=lower if base == "poor" else base, steps=())

    monkeypatch.setattr("rotorrig.identify.verdict.nameplate.select", search)
    monkeypatch.setattr("rotorrig.identify.verdict.nameplate.refit_base", lambda base, p: better)
    monkeypatch.setattr("rotorrig.identify.verdict.nameplate._explanations", lambda base, but: ())
    found = select_beside_nameplate(poor, [], lambda stage, share: None)
    assert (searched, found.base, found.start) == (["poor", "better"], better, better)


@pytest.mark.parametrize(
    ("sigmas", "widened", "named"), [(3.5, (), False), (4.1, (), True), (3.5, SPRING.nuisances, True)]
)
def test_named_is_what_is_pulled_beyond_four_or_explains_more_than_any_effect(
    sigmas: float, widened: tuple[str, ...], named: bool
) -> None:
    check = NameplateCheck(findings=(finding(sigmas),))
    assert (selected(widened=widened).pulled_far(check) == check.findings) is named


@pytest.mark.parametrize(
    ("before", "ties", "after"),
    [
        (Verdict.ADEQUATE, (), Verdict.NAMED),
        (Verdict.CANNOT_TELL, (), Verdict.NAMED),
        (Verdict.ADEQUATE, (("a", "b"),), Verdict.TIED),
        (Verdict.NAMED, (), Verdict.NAMED),
        (Verdict.UNEXPLAINED, (("a", "b"),), Verdict.UNEXPLAINED),
    ],
)
def test_a_config_that_is_wrong_is_not_adequate(
    before: Verdict, ties: tuple[tuple[str, ...], ...], after: Verdict
) -> None:
    assert conclude_with_nameplate(before, [finding(5.0)], ties) is after
    assert conclude_with_nameplate(Verdict.ADEQUATE, [], ()) is Verdict.ADEQUATE


def test_a_finding_is_tied_with_its_alternatives_and_with_effects_that_explain_as_much() -> None:
    named = [finding(5.0, DISK)]
    assert nameplate_ties(selected(), named) == (("bearing_position, spring", "disk_position, disk"),)
    found = selected(widened=SPRING.nuisances, rivals=(cast(Any, Tried(BEND, 10.0)),))
    assert nameplate_ties(found, [finding(5.0)]) == (("bearing_position, spring", "bend"),)
    assert nameplate_ties(selected(), [finding(5.0)]) == ()


def test_an_effect_is_tied_with_what_of_the_nameplate_explains_as_much() -> None:
    assert effect_ties(selected(ALONE, instead=(SPRING,))) == (("bend", "bearing_position, spring"),)
    close = selection([Tried(BEND, 100.0), Tried(LUMP, 95.0)])
    assert effect_ties(selected(close, instead=(SPRING,))) == (("bend", "lump", "bearing_position, spring"),)
    assert effect_ties(selected(NONE, instead=(SPRING,))) == ()


def test_findings_rank_among_the_causes_the_named_first() -> None:
    other = replace(BOW, chosen=False, evidence=12.0)
    check = NameplateCheck(findings=(finding(5.0, DISK),))
    ranked = rank_with_nameplate([other], selected(), check, check.findings)
    assert [(c.label, c.chosen, c.nameplate) for c in ranked] == [
        ("bearing_position, spring", True, True),
        ("bow", False, False),
        ("disk_position, disk", False, True),
    ]
    assert ranked[0].theta == {"off": SPRING.value}
    assert ranked[0].lam == 25.0


@pytest.mark.parametrize(
    ("evidence", "adequate", "freed"),
    [(20.0, False, False), (10.0, False, True), (None, True, False), (None, False, True)],
)
def test_the_prior_is_widened_where_that_explains_more_than_the_best_effect(
    monkeypatch: pytest.MonkeyPatch, evidence: float | None, adequate: bool, freed: bool
) -> None:
    """Evidence of the nameplate is 15; where no effect is called for, only a base that fails its test is refitted."""
    steps = selection([Tried(BEND, evidence)]) if evidence else NONE
    base = SimpleNamespace(problem="base", polished=steps.base, adequacy=SimpleNamespace(adequate=adequate))
    again = SimpleNamespace(problem="wider", polished=None, adequacy=SimpleNamespace(adequate=True))
    monkeypatch.setattr(nameplate, "select", lambda problem, *a, **k: steps if problem == "base" else NONE)
    monkeypatch.setattr(nameplate, "check_nameplate", lambda *a: NameplateCheck(findings=(finding(5.0),)))
    monkeypatch.setattr(nameplate, "_with_wider_prior", lambda base, deviation: again)
    found = select_beside_nameplate(cast(Any, base), [BEND], lambda stage, share: None)
    assert (found.start is again) is freed
    assert [c.effect.label for c in found.rivals] == (["bend"] if freed and evidence else [])
    assert found.instead == ((SPRING,) if evidence and not freed else ())


def told(
    verdict: Verdict, *named: NameplateFinding, tied: tuple[tuple[str, ...], ...] = (), after: Adequacy = RIGHT
) -> str:
    return with_nameplate(said(verdict, BOW), verdict, after, named, tied)


def test_the_sentence_tells_what_of_the_config_is_wrong() -> None:
    words = "spring is 3.0 ± 0.5 mm off"
    assert told(Verdict.ADEQUATE, finding(5.0)).startswith(f"The config is wrong here: {words} (5.0 sigma).")
    assert f"{BOW.words}" in told(Verdict.NAMED, finding(5.0))
    assert f"The config is wrong as well: {words}" in told(Verdict.NAMED, finding(5.0))
    unexplained = told(Verdict.UNEXPLAINED, finding(5.0))
    assert "perhaps for that same unknown reason: bearing_position of spring." in unexplained
    assert words not in unexplained
    assert "; or disk is 3.0 ± 0.5 mm off" in told(Verdict.ADEQUATE, finding(5.0, DISK))
    assert "perhaps for what is left unexplained: spring" in told(Verdict.NAMED, finding(5.0), after=WRONG)
    assert told(Verdict.ADEQUATE) == said(Verdict.ADEQUATE, BOW)


def test_the_sentence_tells_effects_that_explain_as_much() -> None:
    rival = (("bearing_position, spring", "disk_position, disk", "bow"),)
    assert told(Verdict.ADEQUATE, finding(5.0, DISK), tied=rival).count("; or ") == 2


def test_runout_beyond_what_the_config_allows_is_told_and_a_model_without_it_eases_that(
    healthy: OrderTrackedResponse, hidden: np.ndarray
) -> None:
    """60 um at one probe, the slow roll as well."""
    z, slow = healthy.z.copy(), healthy.slow_roll.copy()
    for vectors in (z[..., 0, 0], slow[..., 0, 0]):
        vectors += 60e-6
    problem = problem_of(replace(healthy, z=z, slow_roll=slow))
    fit = assess_fit(problem, problem.solve(problem.parameters.start(hidden)))
    (probe,) = implausible = find_implausible(fit)
    assert probe == f"runout {healthy.probes[0]}"
    assert implausible[probe] == pytest.approx(60e-6 / healthy.rig.prior.runout, rel=0.1)
    found = NameplateSelection(base=fit, start=fit, selection=cast(Any, NONE))
    assert found.describe_misstated() == (f"{probe} by {implausible[probe]:.1f} sigma",)
    without = problem_of(healthy)
    sound = assess_fit(without, without.solve(without.parameters.start(hidden)))
    assert find_implausible(sound) == {}
    assert found.is_eased_by(sound)
    assert not found.is_eased_by(fit)
    assert not NameplateSelection(base=sound, start=sound, selection=cast(Any, NONE)).is_eased_by(fit)
