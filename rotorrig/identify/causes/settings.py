"""Tuning of the search for causes."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class SelectionSettings:
    """Thresholds of acceptance, number of fits, and their limits."""

    # taking causes up
    enough: float = 4.0  # of BIC
    detected: float = 18.0  # of chi2; what healthy simulated rigs score: docs/diagnosis.md
    most: int = 3  # causes at once
    model_error: float = 0.01  # of what the causes so far explain: that much of their vectors may be wrong
    open_end: float = 1e-3  # of chi2, by which a poor base may have ended above its minimum: BaseFitSettings.roughly
    by_base: float = 0.5  # of the fall of chi2 with a cause: where the base alone falls by less, the cause is needed
    as_good: float = 1.0  # of chi2, by which fits of one and the same cause may differ that began elsewhere
    unsure: float = 2.0  # sigmas by which a size may be beyond its plausible range

    # which candidates are fitted, by their scores
    fitted: int = 8  # for every cause taken up: each costs a fit of all recordings
    of_best: int = 3  # of one kind, at other places, if it scores best
    promising: float = 0.05  # of the best score: a candidate below is not fitted
    rival: float = 0.5  # of the best score: those above come by the number of their unknowns
    left_by_law: float = 0.03  # of the excess of chi2: what harmonic balance may leave
    reached: float = 0.2  # of the excess of chi2: a score that leaves less may be all there is to it
    described: float = 2.0  # chi2 per degree of freedom below which a fit describes the data, a poor one above
    loud: float = 200.0  # excess of chi2 at 1X, ten times `detected`: what takes all of it is hardly an imitation

    # scores
    step: float = 1e-4  # of an unknown's size: differences
    little: float = 2e-3  # of the size of what an effect is linear in: differences under a force law, which bends
    spanned: float = 1e-12  # of the loads' greatest singular value: less is rounding
    beyond_base: float = 1e-6  # of a column that the base cannot follow: less is rounding
    scored_together: int = 16  # candidates whose columns are projected at once: passes over the basis take time

    # fits of single candidates
    promised: float = 2.0  # times what a full step promises: a fit that would not get there even so is given up
    promised_by_law: float = 10.0  # the same under a force law, which bends more
    near: float = 48.0  # of BIC, three times what tells two causes apart: one further behind the best is given up
    settled: float = 0.1  # of chi2, where a fit ends
    settled_share: float = 1e-3  # of what is to be explained, where the first fit of a candidate ends, and a refit
    steps: int = 15  # of a fit: a model that is wrong wanders on among its nuisances
    steps_of_law: int = 10  # of a fit under force laws, whose steps take longest
    steps_of_searched: int = 100  # where a pedestal and the bearing on it make up for each other: a narrow, bent valley
    roughly: float = 2e-3  # of chi2: what an initial guess may be short of
    better: float = 2.0  # of chi2: what another initial guess has to promise
    relocations: int = 3  # of a located effect: the place that suited a wrong base is not yet the right one

    # fits with pinned nuisances, which only begin others
    pinned_settled: float = 1.0  # of chi2
    biased: float = 4.0  # sigmas of a prior: a nuisance further off is biased by a cause the model lacks

    # search from the nameplate
    scanned_rows: int = 240  # of the first recording, for what a small amount would do: a weak resonance is narrow
    searched_rows: int = 80  # of the first recording, up and down: 80 rpm apart either way on the RK4
    searched_steps: int = 25  # of a descent with pinned nuisances
    no_change: float = 1e-3  # sigmas of any residual: an effect that changes none by more does nothing at that start
    searched_within: float = 1e-3  # of chi2: where a descent ends
    descents: int = 6  # of every effect, from the best of its clusters
    rival_search: float = 0.3  # of the best of their scores, rough as they are: below, all recordings are not fitted

    # grid search for a location
    moments: int = 16  # of a recording that are tried first for what may happen at any of them
    parts: int = 3  # into which a closer look divides the gaps on either side of the best
    alike: float = 1.0  # of chi2: places that differ by less need no closer look
    looks: int = 12  # closer ones at most: each divides the gap by 3
    one_sigma: float = 1.0  # of chi2, at one standard deviation


SELECTION = SelectionSettings()
