"""Files of other programs: a layout for Foxglove, rotors from and to ROSS."""

from rotorrig.app.commands.other_programs.foxglove_layout import foxglove_layout, write_foxglove_layout
from rotorrig.app.commands.other_programs.ross_exchange import bring_in, write_out

__all__ = [
    "bring_in",
    "foxglove_layout",
    "write_foxglove_layout",
    "write_out",
]
