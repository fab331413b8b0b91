"""Tuning of the search for a missing force."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class DiscoverySettings:
    """Where it is looked for, what is fitted, and when it counts as found."""

    # search
    step: float = 0.01  # m, between places along the shaft
    beyond_base: float = 1e-4  # of the square of a law's column, that the base cannot follow: less tells nothing
    places: int = 2  # of one law that are fitted, where another scores nearly as high
    rival_place: float = 0.5  # of the best score of a law: a place below is left out
    frequencies: int = 24  # between the lowest and the highest speed, at which something may resonate
    rounds: int = 8  # of a fit that runs out of steps: a place and a law bend each other
    fitted: int = 8  # laws that are fitted, best first
    promising: float = 0.05  # of the best score: a law below is not fitted
    worth: float = 0.01  # of what the laws so far explain: a further one explains more
    further: int = 3  # laws tried at a place beside those it has
    laws: int = 3  # at one place, at most

    # found
    widest: float = 0.025  # m, one standard deviation of the place: wider, no place is told
    over_expected: float = 1.5  # of what noise and the model's own stated error leave of unseen data

    beside: float = 0.1  # of what it explains: more may not have to be put down to wrong statements of the config
    explained: float = 0.8  # of the misfit, or all that there is: a law leaves less than that

    # place
    fits: int = 14  # at places beside the best one, at most, to tell how probable they are
    unlikely: float = 16.0  # of chi2 above the best: a place further behind is not looked beyond
    moves: int = 3  # of a fit whose profile is lower at another place, at most
    within: float = 0.3  # of chi2, where such a fit ends

    stretches: int = 12  # of a recording and order, what each of which says of the place by itself

    # force over speed
    knots: int = 40  # at most, between which it is a straight line
    rows_per_knot: int = 6
    determined: float = 1e-6  # of the greatest singular value: what is below is not known


DISCOVERY = DiscoverySettings()
