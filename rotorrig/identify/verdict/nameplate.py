"""The nameplate as a cause: statements of the config that the data contradict, beside the effects.

A group of statements that the base fit pulls beyond three sigmas is a candidate as an effect is. If the evidence for
its best member is more than that for the best effect, the prior of that member is widened, the base refitted and the
effects are searched for once more, beside it: a bearing that sits elsewhere is not to be taken for one whose stiffness
is skew. The pulls that count are those of the final model: under a cause the model lacks, nuisances are off for its
sake.
"""

from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass

from rotorrig.identify.base_fit import BASE_FIT, AssessedFit, assess_fit, refit_base
from rotorrig.identify.causes import Candidate, Selection, is_significant, select
from rotorrig.identify.identification import Deviation, NameplateCheck, NameplateFinding
from rotorrig.identify.uncertainty import check_nameplate, nuisance_pulls
from rotorrig.identify.verdict.cause import Cause, ParameterValue
from rotorrig.identify.verdict.settings import VERDICT
from rotorrig.identify.verdict.verdict import Verdict, tied_labels
from rotorrig.sims.effects import Effect

Progress = Callable[[str, float], None]
Ties = tuple[tuple[str, ...], ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class NameplateSelection:
    """The causes selected, and how the nameplate fared against them."""

    base: AssessedFit
    start: AssessedFit  # the base, with wider priors of what of the nameplate explains more than any effect
    selection: Selection  # of effects beside it
    rivals: tuple[Candidate, ...] = ()  # effects that explain nearly as much as that
    instead: tuple[Deviation, ...] = ()  # or what of the nameplate explains nearly as much as the best effect

    @property
    def widened(self) -> frozenset[str]:
        """Nuisances with wider priors."""
        return self.start.problem.model.widened

    def find_misstated(self) -> tuple[NameplateFinding, ...]:
        """Return what has to be told of the nameplate by the start, without any cause."""
        return self.pulled_far(check_nameplate(self.start.polished, self.start.problem))

    def describe_misstated(self) -> tuple[str, ...]:
        """Say what of the config would have to be wrong without any cause: its statements, then other nuisances."""
        findings = self.find_misstated()
        told = {name for finding in findings for name in finding.deviation.nuisances}
        others = {name: pull for name, pull in find_implausible(self.start).items() if name not in told}
        by = (f"{name} by {pull:.1f} sigma" for name, pull in others.items())
        return (*(finding.words for finding in findings), *by)

    def is_eased_by(self, extended: AssessedFit) -> bool:
        """Say whether less of the config, or fewer nuisances, would have to be wrong with the causes than without."""
        misstated = self.pulled_far(check_nameplate(extended.polished, extended.problem))
        if len(misstated) < len(self.find_misstated()):
            return True
        return len(find_implausible(extended)) < len(find_implausible(self.start))

    def pulled_far(self, check: NameplateCheck) -> tuple[NameplateFinding, ...]:
        """Return the findings of the final model that have to be told: pulled far, or better than any effect."""
        return tuple(
            finding
            for finding in check.findings
            if finding.sigmas > VERDICT.pulled or self.widened.issuperset(finding.deviation.nuisances)
        )


def find_implausible(fit: AssessedFit) -> dict[str, float]:
    """Return the nuisances that a fit pulls so far off that hardly any rig has them there, name -> sigmas.

    Those of the nameplate, of probes and of runout; of a vector, the larger of its parts.
    """
    found: dict[str, float] = {}
    for name, pull in nuisance_pulls(fit.polished, fit.problem.parameters).items():
        if abs(pull) > VERDICT.pulled:
            whole = name.removesuffix(" re").removesuffix(" im")
            found[whole] = max(abs(pull), found.get(whole, 0.0))
    return found


def select_beside_nameplate(
    base: AssessedFit, known: Sequence[Effect], progress: Progress, go_on: Callable[[], bool] = lambda: True
) -> NameplateSelection:
    """Select effects for a base fit, those last that explain less than what of the nameplate the fit pulls at.

    Once `go_on` says no, what has been found is selected. The base of the result is another where a cause has led it to
    a better fit.
    """

    def search(start: AssessedFit) -> Selection:
        wrong = not start.adequacy.adequate
        return select(start.problem, start.polished, known, wrong=wrong, progress=progress, go_on=go_on)

    selection = search(base)
    for _ in range(BASE_FIT.starts):
        if selection.base is base.polished:
            break
        base = refit_base(base, selection.base.p)
        selection = search(base)
    able = [c for c in (selection.steps[0].tried if selection.steps else ()) if is_significant(c)]
    deviations = _explanations(base, but={effect.label for effect in known})
    if not deviations or (base.adequacy.adequate and not able):
        return NameplateSelection(base=base, start=base, selection=selection)
    if able and able[0].evidence > deviations[0].evidence:
        instead = tuple(d for d in deviations if able[0].evidence - d.evidence < VERDICT.nameable)
        return NameplateSelection(base=base, start=base, selection=selection, instead=instead)
    rivals = tuple(c for c in able if deviations[0].evidence - c.evidence < VERDICT.nameable)
    start = _with_wider_prior(base, deviations[0])
    if not start.adequacy.adequate:
        return NameplateSelection(base=base, start=base, selection=selection)  # something else pulls at it
    return NameplateSelection(base=base, start=start, selection=search(start), rivals=rivals)


def _explanations(base: AssessedFit, *, but: Collection[str]) -> tuple[Deviation, ...]:
    """Return the first finding that is none of the labels `but`, which are tried as effects, and its alternatives."""
    for finding in check_nameplate(base.polished, base.problem).findings:
        if finding.deviation.label not in but:
            return (finding.deviation, *(d for d in finding.alternatives if d.label not in but))
    return ()


def _with_wider_prior(base: AssessedFit, deviation: Deviation) -> AssessedFit:
    """Return the base refitted with a wider prior of one statement."""
    problem = base.problem.with_wider_priors(deviation.nuisances)
    return assess_fit(problem, problem.solve(base.polished.p, tolerance=BASE_FIT.settled))


def conclude_with_nameplate(verdict: Verdict, named: Sequence[NameplateFinding], ties: Ties) -> Verdict:
    """Return the verdict on effects with what the nameplate adds: what is named is no longer adequate."""
    if named and verdict in (Verdict.ADEQUATE, Verdict.CANNOT_TELL):
        verdict = Verdict.NAMED
    return Verdict.TIED if verdict is Verdict.NAMED and ties else verdict


def effect_ties(found: NameplateSelection) -> Ties:
    """Return the sets of labels that fit alike, one for every chosen effect with a rival, of the nameplate or not."""
    ties = tied_labels(found.selection)
    if not found.instead or found.selection.problem.effects == found.selection.start.effects:
        return ties
    best = found.selection.steps[0].tried[0].effect.label
    mine = next((group for group in ties if group[0] == best), (best,))
    more = tuple(deviation.label for deviation in found.instead)
    return ((*mine, *more), *(group for group in ties if group is not mine))


def nameplate_ties(found: NameplateSelection, named: Sequence[NameplateFinding]) -> Ties:
    """Return the sets of labels that fit alike, one for every named finding with an alternative, itself first."""
    ties = []
    for finding in named:
        rivals = found.rivals if found.widened.issuperset(finding.deviation.nuisances) else ()
        others = [*(d.label for d in finding.alternatives), *(candidate.effect.label for candidate in rivals)]
        if others:
            ties.append((finding.deviation.label, *dict.fromkeys(others)))
    return tuple(ties)


def rank_with_nameplate(
    causes: Sequence[Cause], found: NameplateSelection, check: NameplateCheck, named: Sequence[NameplateFinding]
) -> tuple[Cause, ...]:
    """Return the causes with the findings among them: what is chosen first, then all others by their evidence."""
    chosen = {cause.label for cause in causes if cause.chosen}
    mine: dict[str, Cause] = {}
    for deviation, is_named in _deviations(found, check, named):
        if deviation.label not in chosen:
            mine.setdefault(deviation.label, _cause(deviation, chosen=is_named))
    every = [*(cause for cause in causes if cause.label not in mine), *mine.values()]
    return tuple(sorted(every, key=lambda c: (not c.chosen, not (c.chosen or c.plausible), -c.evidence)))


def _deviations(
    found: NameplateSelection, check: NameplateCheck, named: Sequence[NameplateFinding]
) -> Iterator[tuple[Deviation, bool]]:
    """Yield what is found of the nameplate, whether it is named, then what else may be."""
    for finding in check.findings:
        yield finding.deviation, finding in named
    for finding in check.findings:
        yield from ((other, False) for other in finding.alternatives)
    yield from ((other, False) for other in found.instead)


def _cause(deviation: Deviation, *, chosen: bool) -> Cause:
    name = deviation.parameter
    return Cause(
        label=deviation.label,
        effect=deviation.kind,
        where=deviation.where,
        title=deviation.title,
        words=deviation.words,
        chosen=chosen,
        plausible=True,
        evidence=deviation.evidence,
        lam=deviation.pull**2,
        heldout_before=float("nan"),
        heldout_after=float("nan"),
        parameters={name: ParameterValue(value=deviation.value, unit=deviation.unit, sigma=deviation.sigma)},
        theta={name: deviation.value},
        sigmas={name: deviation.sigma},
        nameplate=True,
    )
