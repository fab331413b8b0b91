"""Arguments that several verbs of `rotor` have."""

from contextlib import suppress
from pathlib import Path
from typing import Annotated

import typer

from rotorrig.rig import RigError
from rotorrig.rig.config import RigConfig, find_config, load


def load_config(given: Path) -> RigConfig:
    """Read a config that was given by path or, if it is bundled, by name. Raises ConfigError."""
    return load(find_config(given))


def plans_of_the_config(context: typer.Context, incomplete: str) -> list[str]:
    """Return the plans a shell may complete `--plan` with; none where no config given so far can be read."""
    given = [context.params.get("config"), *context.args]  # behind an option without its value it is still a word
    for word in filter(None, given):
        with suppress(RigError):
            return [name for name in load_config(Path(word)).plans if name.startswith(incomplete)]
    return []


Config = Annotated[
    Path, typer.Argument(metavar="CONFIG", help="the rig's TOML file, or a bundled one's name", show_default=False)
]
Out = Annotated[Path, typer.Option("--out", "-o", help="the file to write", show_default=False)]
Response = Annotated[Path, typer.Argument(metavar="RESPONSE", help="a response.mcap", show_default=False)]
Recording = Annotated[Path, typer.Argument(metavar="RUN", help="a run.mcap", show_default=False)]
Seed = Annotated[int, typer.Option(help="of the search; of the simulated rig's hidden deviations")]
Hidden = Annotated[Path | None, typer.Option(help="a sealed file with what the simulated rig hides, instead of a seed")]
Rate = Annotated[float, typer.Option(help="simulated seconds per second, at the most")]
Faults = Annotated[Path | None, typer.Option(help="a script of what goes wrong on the simulated rig, in JSON")]
Trial = Annotated[
    list[str] | None,
    typer.Option(help="a trial mass on the rotor, 'disk: 12 g mm at 90 deg' from the keyphasor mark; repeatable"),
]
Plan = Annotated[str, typer.Option(help="a plan of the config", autocompletion=plans_of_the_config)]
View = Annotated[bool, typer.Option("--view", help="show orbits, Bode plot, speed and time base while it runs")]
AsJson = Annotated[bool, typer.Option("--json", help="print what came of it as one JSON object")]
