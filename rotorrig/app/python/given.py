"""What the verbs are given: paths, as text or Path, or what `rr.read` returned; one response or several."""

from collections.abc import Sequence
from pathlib import Path

from rotorrig.app.commands.diagnose import of_one_rig
from rotorrig.processing import OrderTrackedResponse
from rotorrig.processing.files import read_response
from rotorrig.rig import DataError
from rotorrig.rig.config import RigConfig, find_config, load

PathLike = str | Path
OneResponse = PathLike | OrderTrackedResponse
Responses = OneResponse | Sequence[OneResponse]


def rig_of(config: PathLike | RigConfig) -> RigConfig:
    """Return a config that is given, or read one, of the bundled ones by its name. Raises ConfigError."""
    return config if isinstance(config, RigConfig) else load(find_config(Path(config)))


def list_responses(responses: Responses) -> list[OneResponse]:
    """Return one response or several as a list."""
    return [responses] if isinstance(responses, (str, Path, OrderTrackedResponse)) else list(responses)


def read_responses(responses: Responses, *, config: PathLike | RigConfig | None = None) -> list[OrderTrackedResponse]:
    """Read what is given by path, and hold all of it to one rig. Raises DataError, ConfigError."""
    given = list_responses(responses)
    if not given:
        raise DataError("no response was given, want at least one")
    named = []
    for number, one in enumerate(given, start=1):
        if isinstance(one, OrderTrackedResponse):
            named.append((f"response {number}", one))
        elif isinstance(one, (str, Path)):
            named.append((str(one), read_response(Path(one))))
        else:
            raise DataError(f"response {number}: is a {type(one).__name__}, want a response or the path of one")
    return of_one_rig(named, config=None if config is None else rig_of(config))
