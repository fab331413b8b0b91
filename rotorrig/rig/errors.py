"""Error classes, one per thing a caller can do about it.

Every message says what was got, what is wanted and where. The command line prints it as it stands and exits
non-zero; a traceback is a defect of this program, never the answer to a user's mistake.
"""

LONGEST = 1000  # characters of a message; what it quotes may be of any length


class RigError(Exception):
    """Any fault a person can act on: bad input, a bad wire, a limit reached."""

    def __str__(self) -> str:
        """Return the message as one line that a terminal shows and does not obey, whatever it quotes."""
        line = "".join(letter if letter.isprintable() else " " for letter in super().__str__())
        return line if len(line) <= LONGEST else f"{line[: LONGEST // 2]} ... {line[-LONGEST // 2 :]}"


class ConfigError(RigError):
    """A config or mapping file that cannot be used; correct the file named in the message."""


class DataError(RigError):
    """A recording, response or table that cannot be used as asked."""


class LinkLost(RigError):
    """A device that stopped answering; reconnecting may help, the rotor must be stopped first."""


class BadFrame(RigError):
    """Bytes that are no valid frame: discard them and go on; the message carries their hex."""


class LimitExceeded(RigError):
    """An interlock limit reached: the rotor must be stopped."""


class NotAtRest(RigError):
    """A rotor that turns or may turn when the program ends: see to it before anything else."""
