"""Stepwise selection by itself, on problems whose every chi2 is known: figures of sigma 1, columns of length 1.

An effect along a figure of `a` sigmas takes a^2 from chi2.
"""

from collections.abc import Sequence
from typing import Any, cast

import numpy as np
import pytest

from rotorrig.identify.causes import score_test, selection_step
from rotorrig.identify.causes.candidate_fit import fit_candidate
from rotorrig.identify.causes.settings import SELECTION
from rotorrig.identify.causes.stepwise_selection import Selection, _drop_idle, is_significant, select
from rotorrig.identify.least_squares import Solution, Worth
from rotorrig.sims.effects.base import Effect
from tests.identify.causes.linear_problem import FIGURES, Figures, LinearProblem, Reals, axis, effect

PRICE = np.log(8)  # of an unknown
A, B, C, D = (effect(name) for name in "ABCD")  # of one unknown each


@pytest.fixture(autouse=True)
def scored_by_their_columns(monkeypatch: pytest.MonkeyPatch) -> None:
    """The score test takes an effect's columns from the rotor model; here from the problem."""
    monkeypatch.setattr(
        score_test, "score_columns", lambda problem, p, effects: [problem.figures.of(e) for e in effects]
    )


def measured(falls: Sequence[float]) -> Reals:
    """Figures, the first ones as many sigmas off as makes chi2 fall by `falls`."""
    return np.concatenate([np.sqrt(falls), np.zeros(FIGURES - len(falls))])


def selected(figures: Figures, candidates: Sequence[Effect], *, among: Sequence[Effect] = ()) -> Selection:
    problem: Any = LinearProblem(figures, tuple(among))
    return select(problem, problem.solve(np.zeros(problem.design.shape[1])), candidates, wrong=True)


def alone(**falls: float) -> Figures:
    """Every effect along a figure of its own."""
    return Figures(measured(list(falls.values())), {name: [axis(i)] for i, name in enumerate(falls)})


def names(effects: Sequence[Effect]) -> str:
    return "".join(e.name for e in effects)


def taken(found: Selection) -> str:
    """Name the effects of the last model in alphabetical order: one looked for once more stands last."""
    return "".join(sorted(names(found.problem.effects)))


def tried(found: Selection, step: int) -> str:
    return names([candidate.effect for candidate in found.steps[step].tried])


def test_a_step_takes_the_effect_with_the_most_evidence() -> None:
    """Three unknowns that take 104 from chi2 say less than one that takes 100: they cost 2 ln 8 = 4.2 more."""
    three = effect("T", unknowns=3)
    figures = Figures(measured([100.0, 104.0]), {"A": [axis(0)], "T": [axis(1), axis(2), axis(3)]})
    found = selected(figures, [three, A])
    assert [tried(found, 0), tried(found, 1)] == ["AT", "T"]
    assert taken(found) == "AT"
    first, second = found.steps[0].tried
    assert (first.lam, second.lam) == pytest.approx((100.0, 104.0))
    assert (first.evidence, second.evidence) == pytest.approx((100.0 - PRICE, 104.0 - 3 * PRICE))


def test_what_is_taken_up_is_fitted_beside_what_was() -> None:
    found = selected(alone(A=100.0, B=64.0), [A, B])
    of = found.problem.parameters.of_effect
    sizes = {e.name: of(found.polished.p, i)["size 0"] for i, e in enumerate(found.problem.effects)}
    assert sizes == pytest.approx({"A": 10.0, "B": 8.0})
    assert (found.base.chi2, found.polished.chi2) == pytest.approx((164.0, 0.0), abs=1e-9)
    assert [step.before.chi2 for step in found.steps[:2]] == pytest.approx([164.0, 64.0])


@pytest.mark.parametrize(("fall", "expected"), [(17.9, "A"), (18.1, "AB")])
def test_it_stops_when_no_effect_takes_enough_from_chi2(fall: float, expected: str) -> None:
    found = selected(alone(A=100.0, B=fall, C=12.0), [A, B, C])
    assert taken(found) == expected
    assert tried(found, len(expected)) == "BC"[len(expected) - 1 :]  # the last step forward: what was not enough


@pytest.mark.parametrize(("unknowns", "expected"), [(6, "M"), (8, "")])
def test_it_stops_when_the_unknowns_cost_what_they_gain(unknowns: int, expected: str) -> None:
    """20 of chi2 less 2.08 an unknown leaves 7.5 of six, and 3.4 of eight, less than the 4 asked for."""
    many = effect("M", unknowns=unknowns)
    found = selected(Figures(measured([20.0]), {"M": [axis(i) for i in range(unknowns)]}), [many])
    assert taken(found) == expected


def test_a_second_cause_has_to_exceed_an_error_of_the_first_ones_model() -> None:
    """A hundredth of an amplitude of 400 sigmas is 4: 16 of chi2, beside the 18 asked for anyway."""
    for fall, expected in ((33.0, "A"), (35.0, "AB")):
        assert taken(selected(alone(A=400.0**2, B=fall), [A, B])) == expected


@pytest.mark.parametrize(("fall", "fitted"), [(16.5, ""), (17.5, "B")])
def test_what_scores_less_than_half_of_what_it_needs_is_not_fitted(fall: float, fitted: str) -> None:
    """Beside 400 sigmas 34 of chi2 are needed."""
    found = selected(alone(A=400.0**2, B=fall), [A, B])
    assert tried(found, 1) == fitted
    assert "B" in names([score.effect for score in found.steps[1].scores])


@pytest.mark.parametrize(("both", "alone", "order"), [(900.0, 100.0, "TA"), (600.0, 300.0, "AT")])
def test_what_would_leave_next_to_nothing_is_fitted_before_what_has_fewer_unknowns(
    both: float, alone: float, order: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """T takes what it has in common with A, and a little more; beside it `alone` is left, which neither takes."""
    begun: list[str] = []

    def log(problem: Any, polished: Any, plain: Any, score: Any, **others: Any) -> Any:
        begun.append(score.effect.name)
        return fit_candidate(problem, polished, plain, score, **others)

    monkeypatch.setattr(selection_step, "fit_candidate", log)
    three = effect("T", unknowns=3)
    columns = {"A": [axis(0)], "T": [axis(0), axis(1), axis(2)]}
    problem: Any = LinearProblem(Figures(measured([both, 20.0, 0.0, alone + FIGURES]), columns))
    base = problem.solve(np.zeros(problem.design.shape[1]))
    selection_step.try_candidates(problem, base, [three, A], lambda share: None, wrong=True, first=False)
    assert "".join(begun) == order


@pytest.mark.parametrize(("best", "searched"), [(700.0, True), (900.0, False)])
def test_where_a_score_promises_four_fifths_of_a_loud_misfit_no_other_is_sought_from_the_nameplate(
    best: float, searched: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[int] = []

    def rescore(problem: Any, polished: Any, scored: Any, **others: Any) -> Any:
        asked.append(len(scored))
        return scored

    monkeypatch.setattr(selection_step, "rescore_from_nameplate", rescore)
    monkeypatch.setattr(selection_step, "nuisances_biased", lambda problem, p: True)
    monkeypatch.setattr(selection_step, "fit_with_pinned_nuisances", lambda problem, p: None)
    problem: Any = LinearProblem(alone(A=best, B=1000.0 + FIGURES - best))
    base = problem.solve(np.zeros(problem.design.shape[1]))
    selection_step.try_candidates(problem, base, [A], lambda share: None, wrong=True, first=True)
    assert bool(asked) == searched


@pytest.mark.parametrize(("misfit", "pinned"), [(100.0, False), (1000.0, True)])
def test_candidates_begin_with_pinned_nuisances_beside_a_base_that_is_far_off_alone(
    misfit: float, pinned: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Far off: more than as much again as the 64 figures that noise leaves."""
    asked: list[int] = []

    def log(problem: Any, p: Any) -> None:
        asked.append(len(p))

    monkeypatch.setattr(selection_step, "nuisances_biased", lambda problem, p: True)
    monkeypatch.setattr(selection_step, "fit_with_pinned_nuisances", log)
    problem: Any = LinearProblem(alone(A=misfit))
    base = problem.solve(np.zeros(problem.design.shape[1]))
    selection_step.try_candidates(problem, base, [A], lambda share: None, wrong=False, first=True)
    assert bool(asked) == pinned


def test_a_fit_is_given_up_that_would_not_count_at_twice_what_it_promises(monkeypatch: pytest.MonkeyPatch) -> None:
    """Ten unknowns cost 20.8, and evidence counts from 4 on: twice 12 is not enough, twice 13 is."""
    asked: list[Worth] = []
    solve = LinearProblem.solve

    def watch(self: LinearProblem, start: Reals, **how: Any) -> Solution:
        asked.extend([how["worth"]] if "worth" in how else [])
        return solve(self, start, **how)

    monkeypatch.setattr(LinearProblem, "solve", watch)
    selected(Figures(measured([13.0]), {"M": [axis(i) for i in range(10)]}), [effect("M", unknowns=10)])
    assert [asked[0](13.0, promise) for promise in (12.0, 13.0)] == [False, True]


def test_no_more_than_three_causes_are_taken_up() -> None:
    found = selected(alone(A=130.0, B=120.0, C=110.0, D=100.0), [A, B, C, D])
    assert SELECTION.most == 3
    assert taken(found) == "ABC"
    assert found.polished.chi2 == pytest.approx(100.0)


def test_an_effect_that_two_later_ones_make_superfluous_is_dropped() -> None:
    """A points between B and C, aside by little, and is the best alone; both together leave it nothing to say."""
    between = (axis(0) + axis(1) + 0.4 * axis(2)) / np.sqrt(2.16)
    figures = Figures(30.0 * axis(0) + 15.0 * axis(1), {"A": [between], "B": [axis(0)], "C": [axis(1)]})
    found = selected(figures, [A, B, C])
    assert [step.tried[0].effect.name for step in found.steps[:3]] == ["A", "B", "C"]
    assert found.steps[0].tried[0].lam == pytest.approx(45.0**2 / 2.16)
    assert found.steps[2].tried[0].lam == pytest.approx(15.0**2 * 0.16 / 1.16)
    assert taken(found) == "BC"
    again = [names(step.tried[0].problem.effects) for step in found.steps[3:]]
    assert again == ["CB", "BC"]  # each looked for once more beside the other, and no longer beside A
    assert len(found.polished.p) == 3
    assert found.polished.chi2 == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(("second", "again"), [(30.0, False), (100.0, True)])
def test_another_is_tried_again_in_place_of_a_cause_if_it_came_as_near_as_what_is_found_since(
    second: float, again: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """R was behind A by 144: too far with 48 and twice the 30 that B takes, and not with twice 100."""
    begun: list[str] = []

    def log(problem: Any, polished: Any, plain: Any, score: Any, **others: Any) -> Any:
        begun.append(names(problem.effects) + score.effect.name)
        return fit_candidate(problem, polished, plain, score, **others)

    monkeypatch.setattr(selection_step, "fit_candidate", log)
    rival = 0.8 * axis(0) + 0.6 * axis(2)
    figures = Figures(20.0 * axis(0) + np.sqrt(second) * axis(1), {"A": [axis(0)], "B": [axis(1)], "R": [rival]})
    found = selected(figures, [A, B, effect("R")])
    assert taken(found) == "AB"
    assert "R" in begun  # beside nothing, where it was behind
    assert ("BR" in begun) == again
    assert "BA" not in begun


def test_what_explains_as_much_beside_another_takes_no_ones_place() -> None:
    """R leans from A against B: alone it is behind A by 220, beside B the two are the same."""
    against = (axis(0) - 0.5 * axis(1)) / np.sqrt(1.25)
    figures = Figures(20.0 * axis(0) + 10.0 * axis(1), {"A": [axis(0)], "B": [axis(1)], "R": [against]})
    found = selected(figures, [A, B, effect("R")])
    assert taken(found) == "AB"


def left(*, kept: int = 0, **falls: float) -> str:
    """Name the effects that are left of a model of those named."""
    effects = [e for e in (A, B, C) if e.name in falls]
    problem: Any = LinearProblem(alone(**falls), tuple(effects))
    smaller, fit = _drop_idle(problem, problem.solve(np.zeros(len(falls) + 1)), kept=kept)
    assert len(fit.p) == len(smaller.effects) + 1
    assert fit.chi2 == pytest.approx(sum(falls[e.name] for e in effects if e not in smaller.effects), abs=1e-9)
    return names(smaller.effects)


def test_an_effect_stays_if_without_it_bic_rises_by_enough() -> None:
    """It has to be worth ln 8 + 4 = 6.08."""
    assert left(A=6.0, B=100.0) == "B"
    assert left(A=6.2, B=100.0) == "AB"
    assert left(A=1.0, B=2.0, C=100.0) == "C"


def test_neither_the_configs_effects_nor_the_one_just_taken_are_dropped() -> None:
    assert left(A=0.0, B=100.0, C=0.0, kept=1) == "ABC"
    assert left(A=0.0, B=0.0, C=0.0, kept=1) == "AC"


def test_what_the_config_has_is_not_looked_for_again() -> None:
    found = selected(alone(A=100.0, B=81.0), [A, B], among=[A])
    assert names([score.effect for score in found.steps[0].scores]) == "B"
    assert taken(found) == "AB"
    assert found.base.chi2 == pytest.approx(81.0)


def test_two_effects_that_explain_the_data_alike_are_both_reported_and_one_is_taken() -> None:
    figures = Figures(measured([400.0, 9.0]), {"A": [axis(0)], "B": [axis(0)], "C": [axis(1)]})
    for candidates in ([A, B, C], [B, A, C]):
        found = selected(figures, candidates)
        first, second = found.steps[0].tried
        assert {first.effect.name, second.effect.name} == {"A", "B"}
        assert first.evidence == pytest.approx(second.evidence)
        assert found.problem.effects == (first.effect,)
        assert len(found.steps) == 2
        assert found.steps[1].tried == ()  # beside the one the other says nothing


def test_a_rival_a_little_behind_is_reported_with_how_far() -> None:
    """Along a column 30 degrees off, three quarters of chi2 are taken."""
    aside = np.cos(np.pi / 6) * axis(0) + np.sin(np.pi / 6) * axis(1)
    found = selected(Figures(measured([100.0]), {"A": [aside], "B": [axis(0)]}), [A, B])
    assert tried(found, 0) == "BA"
    best, rival = found.steps[0].tried
    assert best.evidence - rival.evidence == pytest.approx(25.0)
    assert taken(found) == "B"


def searched(fall: float, candidate: Effect) -> Selection:
    """Select where the figure of place 7 is off."""
    places = [axis(i) for i in range(12)]
    return selected(Figures(np.sqrt(fall) * axis(7), {"G": places, "F": [axis(7)]}), [candidate])


def test_an_effect_looked_for_in_many_places_has_to_explain_more() -> None:
    """The best of fifty places gains 2 ln 50 = 7.8 by chance: 25.8 are asked for, not 18."""
    fixed, everywhere = effect("F"), effect("G", places=12)
    for fall, of_fixed, of_searched in ((17.0, "", ""), (22.0, "F", ""), (25.7, "F", ""), (25.9, "F", "G")):
        assert taken(searched(fall, fixed)) == of_fixed, fall
        found = searched(fall, everywhere)
        assert taken(found) == of_searched, fall
        best = found.steps[0].tried[0]
        assert best.effect.at_zero["place"] == 7.0
        assert best.lam == pytest.approx(fall)
        assert is_significant(cast(Any, best)) is bool(of_searched)
