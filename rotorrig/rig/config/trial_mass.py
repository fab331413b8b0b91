"""`TrialMass`: a known mass put on a disk for a whole recording, and how it is written: "disk: 12 g mm at 90 deg"."""

import cmath
from collections.abc import Collection, Iterable

from rotorrig.rig.config.nameplate import Angle, Part, UnbalanceAmount
from rotorrig.rig.config.validation import validate_table
from rotorrig.rig.errors import ConfigError

NO_TRIAL = "none"  # what a recording says when every trial mass has been taken off
_WANT = "want a disk, an amount and an angle from the keyphasor mark, such as 'disk: 12 g mm at 90 deg'"


class TrialMass(Part):
    """A known unbalance on a disk; the angle is from the keyphasor mark, in the sense of rotation."""

    disk: str
    amount: UnbalanceAmount
    angle: Angle


def read_trial_mass(text: str, *, planes: Collection[str]) -> TrialMass:
    """Return what "disk: 12 g mm at 90 deg" says. Raises ConfigError, in one sentence.

    `planes` are the disks and massless planes it may sit on: `RigConfig.unbalance_planes`.
    """
    disk, colon, rest = (part.strip() for part in text.rpartition(":"))
    amount, at, angle = rest.rpartition(" at ")
    if not (colon and at):
        raise ConfigError(f"trial mass: got '{text}', {_WANT}")
    if disk not in planes:
        raise ConfigError(f"trial mass '{text}': the config has no disk or plane '{disk}', want one of {list(planes)}")
    table = {"disk": disk, "amount": amount, "angle": angle}
    return validate_table(TrialMass, table, where=f"trial mass '{text}'")


def trial_unbalance(masses: Iterable[TrialMass]) -> dict[str, complex]:
    """Return the unbalance [kg m] that the masses add per disk.

    >>> half = TrialMass(disk="disk", amount="6 g mm", angle="0 deg")
    >>> trial_unbalance([half, half])
    {'disk': (1.2e-05+0j)}
    """
    added: dict[str, complex] = {}
    for mass in masses:
        added[mass.disk] = added.get(mass.disk, 0j) + cmath.rect(mass.amount, mass.angle)
    return added
