"""Tuning of the verdict."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class VerdictSettings:
    """Settings of separability, conclusions, cross-validation and planned runs."""

    # separability, as lambda
    detectable: float = 25.0  # against the base: five standard deviations
    nameable: float = 16.0  # against the nearest other cause: four standard deviations
    hoped: float = 2.0  # times what a full step promises: a fit that would not get there even so is given up
    hoped_of_laws: float = 10.0  # the same under force laws, which bend more
    separated_within: float = 0.3  # of chi2, where a fit by a rival ends
    separated_rows: int = 60  # of the first recording, on which its start is chosen
    separated_starts: int = 6  # the best of which are looked at in all rows
    separated_steps: int = 200  # of such a fit, which is done before: one that stops short tells apart what is alike

    # conclusions
    left_over: float = 0.03  # of the excess of chi2 or of the mean square error that causes may leave: no law is exact
    over_expected: float = 4.0  # of the error of unseen data then: twice that of clearances and springs that were found
    pulled: float = 4.0  # sigmas: what of the config is pulled further is named whatever the verdict is
    enough_visible: float = 0.5  # of the known effects, at typical size: below, data that show nothing say nothing
    agreeing: float = 0.01  # probability that base and causes from disjoint parts of the data differ as much
    fewest_rows: int = 16  # of a recording below its peak and above it, that tell its rotor twice
    fewest_blocks: int = 8  # of a recording, whose errors tell the standard error of a gain
    measured: int = 3  # best causes whose prediction is measured: each costs a cross-validation
    might_lead: float = 48.0  # of BIC: one further behind the best leads in no part of the rows, three times `nameable`

    # cross-validation
    block: int = 24  # rows that are left out together, at most: neighbours share their noise
    blocks: int = 6  # that a run is divided into at least
    folds: int = 3  # in each of which every third block is hidden
    accurate: float = 0.3  # of chi2, where a refit ends
    gained: float = 1.0  # of -2 log predictive density of unseen data: less is no gain
    nearly: float = 5e-4  # of the chi2 of a model that is wrong
    close: int = 20  # times that: what so short a step leaves, the derivatives before it tell
    refit_steps: int = 3  # half of the rows move a fit by little

    # planned runs
    trial: float = 12e-6  # kg m, at 90 degrees, of a trial mass
    ramp: float = 3.0  # rad/s^2, where neither recording nor config says one
    turns: float = 8.0  # of a row at the most, where the recording does not say: more would smear a resonance
    lowest: float = 0.9  # of the highest speed, where a planned sweep begins at the highest
    fewest_rpm: float = 300.0  # where a planned sweep begins at the lowest
    of_overspeed: float = 0.95  # of the overspeed limit: the highest speed of a planned run
    higher: float = 1.05  # times the highest speed so far: what goes no higher than that is no other run
    settle: float = 2.0  # s, at a speed that is held, before it is recorded
    dwell: float = 20.0  # s, that it is recorded
    dwells: int = 4  # speeds that are held, at the most
    apart: float = 0.03  # of a speed: nearer ones are not both held
    mounting: float = 180.0  # s of hands, for a trial mass
    fitting: float = 1200.0  # for more probes
    rewiring: float = 300.0  # for a drive that is to turn the other way
    worthwhile: float = 4.0  # expected separation, two standard deviations: a run that tells less is not made
    of_limit: float = 0.7  # of a vibration limit: a run that may pass it is not proposed
    draws: int = 16  # of every fitted model, for its vibration
    halved: int = 20  # times at most, a step that leads beyond what the data leave open


VERDICT = VerdictSettings()
