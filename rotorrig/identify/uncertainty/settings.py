"""Settings of the uncertainties: levels, limits from which something is said, and how an interval's end is sought."""

from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True, kw_only=True)
class ProfileSettings:
    """Search for one end of a profile-likelihood interval."""

    close: float = 0.01  # of the rise: half a per cent of an interval's half width
    settled: float = 0.003  # of the rise: what a trial may still promise
    trials: int = 20  # an end takes two to eight
    steps: int = 6  # in a trial
    halvings: int = 5  # of a step that raises chi2
    longest: float = 0.7  # of a quantity's scale, from one trial to the next
    inside: float = 0.1  # of a bracket: the next trial is that far from its ends
    narrow: float = 0.005  # of the way from the optimum: narrow enough, even where chi2 jumps between valleys
    none: float = 4.0  # standard deviations: an unbalance smaller than that may be none at all
    nothing: float = 1e-3  # of an unbalance: stands for none, for which nothing could be derived
    at_bound: float = 1e-9  # of a quantity's scale; parameters with bounds are of the order of one


@dataclass(frozen=True, slots=True, kw_only=True)
class UncertaintySettings:
    """Limits of intervals, of the bootstrap, and of what counts as determined."""

    level: float = 0.95  # of all intervals
    half_width: float = 1.959964  # standard deviations: the normal distribution's for `level`
    curved: float = 0.2  # of a quantity's scale: a larger sigma wants the profile
    near: float = 3.0  # sigma from a bound, likewise
    fewest_draws: int = 40  # of a bootstrap, of which one is beyond either end of a 95 % interval
    determined: float = 0.5  # relative standard deviation from which on the data do not determine something
    takes_part: float = 0.1  # of the largest weight: less is not worth a word
    inseparable: float = 0.99  # correlation from which two determined quantities are better known together
    limited: float = 0.9  # share of a variance that is the nameplate's, from which on less noise would not help
    pulled: float = 3.0  # sigmas: a group of the config's statements pulled further is a finding
    unsure: float = 2.0  # sigmas by which a statement may be off by more than can be
    known: float = 0.1  # relative standard deviation up to which a combination is worth naming
    shown: float = 0.1  # relative change in an example
    profile: ProfileSettings = field(default_factory=ProfileSettings)

    @property
    def rise(self) -> float:
        """Rise of chi2 at either end of an interval."""
        return self.half_width**2


UNCERTAINTY = UncertaintySettings()
