"""Critical speeds and effects of a config's rotor model."""

from threadpoolctl import threadpool_limits

from rotorrig.rig import ConfigError
from rotorrig.rig.config import RigConfig


@threadpool_limits.wrap(limits=1, user_api="blas")  # many small eigenvalue problems: threads only slow them down
def criticals_of(rig: RigConfig) -> list[float]:
    """Return the 1X critical speeds of the nameplate model [rad/s], up to the maximum speed of the rig."""
    from rotorrig.sims.rotor.model import assemble
    from rotorrig.sims.rotor.modes import critical_speeds

    ceiling = rig.motor.max_speed if rig.motor else 1000.0
    return [float(speed) for speed in critical_speeds(assemble(rig), up_to=ceiling)]


def criticals_to_pass(rig: RigConfig) -> list[float]:
    """Return the critical speeds [rad/s] a sweep must pass quickly: if the config sets a rate and no bands."""
    if rig.limits is None or rig.limits.critical_ramp is None or rig.limits.critical_bands:
        return []
    return criticals_of(rig)


def check_effects(rig: RigConfig) -> None:
    """Raise ConfigError if the config names an effect or a parameter that the model does not have."""
    if not rig.effects:
        return
    from rotorrig.sims.effects import find  # numba takes a second to import

    for effect in rig.effects:
        try:
            known = [parameter.name for parameter in find(rig, effect.label).parameters]
        except ValueError as error:
            raise ConfigError(f"{rig.name}: effects: {error}") from error
        for name in effect.parameters:
            if name not in known:
                raise ConfigError(f"{rig.name}: effects: '{effect.label}' has no '{name}', want one of {known}")
