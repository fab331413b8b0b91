"""Steps of a sweep, each one request to the rig; plans make them, the engine performs them."""

from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class Ramp:
    """Go to speed `to` [rad/s] at `rate` [rad/s^2] and wait until there.

    With `until` the next step begins as soon as that speed [rad/s] is passed on the way: the rate may change without
    a halt.
    """

    to: float
    rate: float
    until: float | None = None

    @property
    def end(self) -> float:
        """The speed at which the next step begins [rad/s]."""
        return self.to if self.until is None else self.until


@dataclass(frozen=True, slots=True, kw_only=True)
class Dwell:
    """Hold the speed for `seconds` of the sample clock."""

    seconds: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Coast:
    """Power off; wait until the speed by the keyphasor is below `until` [rad/s]."""

    until: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Rest:
    """Stop down the ramp last asked for and wait until keyphasor and drive say that the rotor is at rest."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Ask:
    """With the rotor at rest, wait until the operator has done what `request` says. Samples are not recorded."""

    request: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Mark:
    """Write `label` into the recording: "slow roll", "up", "down", which name the runs of a response."""

    label: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Trial:
    """Write into the recording which trial mass is on the rotor from here on, beside those noted before.

    "disk: 12 g mm at 90 deg"; rig.trial_mass.NO_TRIAL says that none is on any more.
    """

    mass: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Provoke:
    """Provoke a protection at the present speed and wait until it has stopped the rotor: a proof test's step.

    `has_stopped` is asked after every block; it raises LimitExceeded if the rotor does not stop as it should. Without
    `limits` the interlock looks away, as the drive has to stop the rotor by itself.
    """

    what: str
    act: Callable[[], None]
    has_stopped: Callable[[], bool]
    limits: bool = True


Step = Ramp | Dwell | Coast | Rest | Ask | Mark | Trial | Provoke
