"""Tuning of the adequacy tests; how often healthy rigs fail them: benchmarks/healthy.py, docs/adequacy.md."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class AdequacySettings:
    """Limits of both tests, and how a misfit is described."""

    stretch: int = 8  # neighbouring rows tested together: an effect that is loud in a narrow band is seen
    neighbours: int = 1  # stretches on either side that tell its noise
    ringing: int = 3  # rows apart: at half orders neighbours follow each other, see residual_tests.py
    false_alarm_rate: float = 0.01  # of both tests together
    position_limit: float = 2.5  # rms sigma of a stretch of the mean position from which it is told: mean_position.py
    alike: float = 0.35  # of the residual: two runs that differ by less are wrong in the same way
    one_sided: float = 0.8  # of the residual's square, from which it is called forward or backward
    least_rows: int = 3  # of the other run, for a comparison with it
    fewest_rows: int = 16  # of a run that tell a change of its mean position from scatter


ADEQUACY = AdequacySettings()
