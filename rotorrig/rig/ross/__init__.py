"""Exchange of rotors with ROSS: its TOML files to a config and back."""

from rotorrig.rig.ross.from_config import ross_rotor
from rotorrig.rig.ross.reading import read_ross
from rotorrig.rig.ross.rotor import RossRotor
from rotorrig.rig.ross.to_config import config_text, sections
from rotorrig.rig.ross.writing import ross_text

__all__ = [
    "RossRotor",
    "config_text",
    "read_ross",
    "ross_rotor",
    "ross_text",
    "sections",
]
