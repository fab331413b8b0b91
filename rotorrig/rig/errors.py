"""What can go wrong, one class per thing a caller can do about it.

Every message says what was got, what is wanted and where. The command line prints it as it stands and exits
non-zero; a traceback is a defect of this program, never the answer to a user's mistake.
"""


class RigError(Exception):
    """Any fault a person can act on: bad input, a bad wire, a limit reached."""


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


class NotBuilt(RigError):
    """Asked for something this version does not do yet."""
