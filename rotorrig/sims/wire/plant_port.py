"""Interface of the plant to the emulators; `rotorrig.sims.plant.plant.Plant` has it."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray


class Plant(Protocol):
    """A rotor with its motor and sensors, moved on in time by `advance`."""

    @property
    def sample_rate(self) -> float:
        """Samples per second and channel [Hz]."""
        ...

    @property
    def channels(self) -> int:
        """Number of channels of a scan."""
        ...

    @property
    def volts_per_count(self) -> tuple[float, ...]:
        """Volts per count (channel,)."""
        ...

    @property
    def full_scale_counts(self) -> int:
        """Counts run from -full_scale_counts to full_scale_counts - 1."""
        ...

    @property
    def t(self) -> float:
        """Simulated time [s]."""
        ...

    @property
    def speed(self) -> float:
        """Shaft speed [rad/s]."""
        ...

    def command(self, setpoint: float, ramp: float, powered: bool) -> None:
        """Head for `setpoint` [rad/s] at `ramp` [rad/s^2] when powered, else coast."""
        ...

    def advance(self, t: float) -> NDArray[np.int32]:
        """Move on to time `t` [s]; return the counts since the last call, (sample, channel)."""
        ...
