"""Arguments and options shared by several verbs of `rotor`."""

from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rotorrig.rig import ConfigError, RigError
from rotorrig.rig.config import RigConfig, find_config, load

if TYPE_CHECKING:
    from rotorrig.app.text import AmplitudeUnit


def load_config(given: Path) -> RigConfig:
    """Read a config that was given by path or, if it is bundled, by name. Raises ConfigError."""
    return load(find_config(given))


def unit_of_view(units: str | None, *, view: bool) -> "AmplitudeUnit":
    """Return in which unit a live view tells amplitudes. Raises ConfigError without one, DataError for another unit."""
    from rotorrig.app.text import AS_STATED, AmplitudeUnit, read_amplitude_unit

    if units and not view:
        raise ConfigError("--units: goes with --view")
    return AmplitudeUnit(read_amplitude_unit(units, where="--units")) if units else AS_STATED


def plans_of_the_config(context: typer.Context, incomplete: str) -> list[str]:
    """Return the plan names for shell completion of `--plan`; none if no config given so far can be read."""
    given = [context.params.get("config"), *context.args]  # behind an option without its value it is still a word
    for word in filter(None, given):
        with suppress(RigError):
            return [name for name in load_config(Path(word)).plans if name.startswith(incomplete)]
    return []


Config = Annotated[
    Path, typer.Argument(metavar="CONFIG", help="the rig's TOML file, or a bundled one's name", show_default=False)
]
OUT = typer.Option("--out", "-o", help="the file to write", show_default=False)
Force = Annotated[bool, typer.Option("--force", help="replace an existing file, if it is of the same kind")]
Response = Annotated[Path, typer.Argument(metavar="RESPONSE", help="a response.mcap", show_default=False)]
Recording = Annotated[Path, typer.Argument(metavar="RUN", help="a run.mcap", show_default=False)]
Seed = Annotated[int, typer.Option(help="random seed: of the search, or of the simulated rig's hidden truth")]
Hidden = Annotated[Path | None, typer.Option(help="sealed truth file of the simulated rig, instead of a seed")]
Rate = Annotated[float, typer.Option(help="simulated seconds per second, at most")]
Faults = Annotated[Path | None, typer.Option(help="JSON script of faults on the simulated rig")]
Trial = Annotated[
    list[str] | None,
    typer.Option(help="trial mass on the rotor, 'disk: 12 g mm at 90 deg' from the keyphasor mark; repeatable"),
]
Hold = Annotated[
    list[str] | None,
    typer.Option(help="speed that a stepped plan holds instead of its own, '1200 rpm'; repeatable"),
]
Plan = Annotated[str, typer.Option(help="sweep plan in the config", autocompletion=plans_of_the_config)]
Units = Annotated[
    str | None,
    typer.Option(help="amplitudes in 'um pp', 'mil pp' or 'mil 0-peak'; a page can switch", show_default=False),
]
LiveUnits = Annotated[
    str | None, typer.Option("--units", help="amplitudes of --view in 'um pp', 'mil pp' or 'mil 0-peak'")
]
View = Annotated[bool, typer.Option("--view", help="show orbits, Bode plots, speed and time base live")]
AsJson = Annotated[bool, typer.Option("--json", help="print the result as one JSON object")]
