"""What no known cause explains: the missing force, its place and its law, or the probe that reads otherwise."""

from rotorrig.identify.discovery.discover import Discovery, discover
from rotorrig.identify.discovery.force_over_speed import ForceOverSpeed
from rotorrig.identify.discovery.missing_force import MissingForce, Rival

__all__ = ["Discovery", "ForceOverSpeed", "MissingForce", "Rival", "discover"]
