from .clock import Clock as Clock
from .clock import WallClock as WallClock
from .errors import ConfigError as ConfigError
from .errors import DataError as DataError
from .errors import LimitExceeded as LimitExceeded
from .errors import LinkLost as LinkLost
from .errors import NotAtRest as NotAtRest
from .errors import RigError as RigError
from .interlock import Interlock as Interlock
from .provenance import Provenance as Provenance
from .provenance import code_version as code_version
from .provenance import file_hash as file_hash
from .provenance import short_hash as short_hash
from .whole_file import provisional_file as provisional_file
from .whole_file import provisional_path as provisional_path
from .whole_file import sync_folder as sync_folder
from .whole_file import write_whole_file as write_whole_file
from .whole_file import write_whole_text as write_whole_text

__all__ = [
    "Clock",
    "ConfigError",
    "DataError",
    "Interlock",
    "LimitExceeded",
    "LinkLost",
    "NotAtRest",
    "Provenance",
    "RigError",
    "WallClock",
    "code_version",
    "file_hash",
    "provisional_file",
    "provisional_path",
    "short_hash",
    "sync_folder",
    "write_whole_file",
    "write_whole_text",
]
