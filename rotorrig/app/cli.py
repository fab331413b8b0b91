"""Command `rotor`. Its verbs are in app/verbs: each parses, calls one public function and prints the result.

Heavy libraries are imported inside the verb that needs them, so that `rotor --help` is quick.
"""

import sys
from collections.abc import Callable
from typing import Annotated, Any

import typer
from rich.text import Text
from typer.core import TyperGroup

from rotorrig.app.terminal import err, out
from rotorrig.app.verbs import balancing, data, lab, model, rig
from rotorrig.app.verbs.output_guard import guard
from rotorrig.rig import RigError

__all__ = ["app", "err", "main", "out"]


class Rotor(TyperGroup):
    """The command; its help leaves out its own options, to stay on a screen of 24 lines: docs/cli.md has them."""

    def list_commands(self, ctx: Any) -> list[str]:
        """Return the verbs in the order of a session, those with verbs of their own last."""
        return sorted(super().list_commands(ctx), key=lambda name: name not in VERBS)

    def format_help_text(self, ctx: Any, formatter: Any) -> None:
        """Write what the command is for without a blank line before it."""
        with formatter.indentation():
            formatter.write_text(self.help or "")

    def format_epilog(self, ctx: Any, formatter: Any) -> None:
        """Write the last line without a blank one before it."""
        formatter.write_text(self.epilog)

    def get_params(self, ctx: Any) -> list[Any]:
        """Return the options that belong to no verb."""
        options: list[Any] = super().get_params(ctx)
        for option in options:
            option.hidden = True
        return options


app = typer.Typer(
    cls=Rotor,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,  # plain help: fits a screen of 24 lines
    help="Acquisition, order tracking, identification and diagnosis of a rotor kit.",
    epilog="`rotor VERB --help` tells more of a verb, `rotor --version` the version.",
    context_settings={"help_option_names": ["-h", "--help"]},
)

#: in the order of a session: one-line help and function
VERBS: dict[str, tuple[str, Callable[..., None]]] = {
    "init": ("Write a bundled config to start from, or list them.", rig.init),
    "check": ("Check a config; with --connect, query its devices.", rig.check),
    "sweep": ("Run a sweep and record it; with --dry-run, preview it.", rig.sweep),
    "stop": ("Stop the rotor, whoever started it.", rig.stop),
    "replay": ("Play a recording as if it were live.", data.replay),
    "track": ("Track the orders of a recording into a response.", data.track),
    "identify": ("Fit bearing stiffness, damping and unbalance.", model.identify),
    "diagnose": ("Test the model; locate misfit and name its cause.", model.diagnose),
    "investigate": ("Sweep and diagnose until the cause is known.", rig.investigate),
    "balance": ("Say which mass to put where, and what it will do.", balancing.balance),
    "predict": ("Predict vibration with masses on, by the fit.", balancing.predict),
    "report": ("Write a self-contained HTML report.", model.report),
    "view": ("Open a recording or response in the Rerun viewer.", model.view),
    "import": ("Import CSV, UFF, TDMS, WAV, a Bode table, a rotor.", data.import_),
    "export": ("Export a run or a response to CSV or UFF.", data.export),
    "simulate": ("Run a simulated rig on real ports until Ctrl-C.", rig.simulate),
    "salvage": ("Recover a truncated recording.", data.salvage),
    "demo": ("Run the whole chain on a simulated RK4.", rig.demo),
}


def show_version(wanted: bool) -> None:
    """Print the version, of a checkout with its commit, and end."""
    if wanted:
        from rotorrig.rig import code_version

        print(f"rotorrig {code_version()}")
        raise typer.Exit


@app.callback()
def options(
    version: Annotated[
        bool, typer.Option("--version", callback=show_version, is_eager=True, help="Show the version and exit.")
    ] = False,
) -> None:
    """Take the options that belong to no verb."""


for name, (in_a_line, verb) in VERBS.items():
    app.command(name, short_help=in_a_line)(guard(verb))
app.add_typer(lab.app, name="lab", short_help="Work through all recordings of a folder; query them.")


def main() -> None:
    """Run the command; a user error ends in one sentence and a non-zero exit, never in a traceback."""
    try:
        app()
    except RigError as error:
        err.print(Text("error:", style="red"), Text(str(error)), highlight=False, soft_wrap=True)
        sys.exit(1)


if __name__ == "__main__":
    main()
