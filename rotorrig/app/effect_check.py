"""Whether the model knows the effects of a config."""

from rotorrig.rig.description import RigConfig
from rotorrig.rig.errors import ConfigError


def check_effects(rig: RigConfig) -> None:
    """Raise ConfigError unless the model knows every effect in the config, and every parameter of it."""
    if not rig.effects:
        return
    from rotorrig.sims.effects.base import find  # numba takes a second to import

    for effect in rig.effects:
        try:
            known = [parameter.name for parameter in find(rig, effect.label).parameters]
        except ValueError as error:
            raise ConfigError(f"{rig.name}: effects: {error}") from error
        for name in effect.parameters:
            if name not in known:
                raise ConfigError(f"{rig.name}: effects: '{effect.label}' has no '{name}', want one of {known}")
