"""What an investigation may cost: runs, and time at the rig."""

import math
import re
from dataclasses import dataclass

from rotorrig.rig import ConfigError
from rotorrig.rig.config import read_quantity

RUNS = 6  # where only a time is said
WANT = "want '6 runs', '30 min' or both, separated by a comma"


@dataclass(frozen=True, slots=True, kw_only=True)
class Budget:
    """At most so many runs, and so much time of sweeps; the program's own time and the operator's are not counted."""

    runs: int = RUNS
    seconds: float = math.inf

    def allows(self, *, runs: int, seconds: float) -> bool:
        """Say whether so many runs of so much time in all are within it."""
        return runs <= self.runs and seconds <= self.seconds


def read_budget(text: str, *, where: str) -> Budget:
    """Read "6 runs, 30 min". Raises ConfigError, in one sentence.

    >>> read_budget("4 runs, 10 min", where="--budget")
    Budget(runs=4, seconds=600.0)
    """
    found: dict[str, float] = {}
    for part in (part.strip() for part in text.split(",")):
        runs = re.fullmatch(r"(\d+) runs?", part)
        key = "runs" if runs else "seconds"
        if key in found:
            raise ConfigError(f"{where}: '{text}' says {'runs' if runs else 'a time'} twice, {WANT}")
        if runs:
            found[key] = int(runs[1])
            continue
        try:
            found[key] = read_quantity(part, "time", where=where, positive=True)
        except ConfigError as error:
            raise ConfigError(f"{where}: got '{part}', {WANT}") from error
    if found.get("runs", 1) < 1:
        raise ConfigError(f"{where}: got '{text}', want at least 1 run")
    return Budget(runs=int(found.get("runs", RUNS)), seconds=found.get("seconds", math.inf))
