"""Tuning of the adequacy tests; the limits are those of benchmarks/healthy.py, figures in docs/adequacy.md."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class AdequacySettings:
    """Limits of both tests, and how a misfit is described."""

    stretch: int = 8  # neighbouring rows tested together: an effect that is loud in a narrow band is seen
    global_limit: float = 1.0  # chi2 per degree of freedom of 1X
    focused_limit: float = 2.5  # rms sigma of the worst stretch
    false_alarm_rate: float = 0.03  # 95 % bound from no alarm in 100 simulated healthy rigs
    alike: float = 0.35  # of the residual: two runs that differ by less are wrong in the same way
    one_sided: float = 0.8  # of the residual's square, from which it is called forward or backward
    least_rows: int = 3  # of the other run, for a comparison with it
    fewest_rows: int = 16  # of a run that tell a change of its mean position from scatter
    roundness: float = 0.5  # of the largest mean a round shaft makes, in one standard deviation: a probe sees a part


ADEQUACY = AdequacySettings()
