"""What stands in a file or comes from a device is shown at the terminal, and never obeyed."""

import pytest
from rich.table import Table

from rotorrig.app.terminal.console import err, out

HOSTILE = "[bold]x[/] [/red] [link=evil]y :smile: \\[z]"


@pytest.mark.parametrize("control", ["\x1b[2J", "\x1b]0;owned\x07", "\r", "\x9b2J", "\u202e", "\ud800"], ids=ascii)
@pytest.mark.parametrize("where", ["line", "cell", "title", "rule"])
def test_names_and_messages_are_no_orders(control: str, where: str, capsys: pytest.CaptureFixture[str]) -> None:
    text = f"{HOSTILE} {control} end"
    for terminal in (out, err):
        match where:
            case "line":
                terminal.print(text, highlight=False, soft_wrap=True)
            case "rule":
                terminal.rule(text)
            case _:
                table = Table("part", title=text if where == "title" else "")
                table.add_row(text if where == "cell" else "")
                terminal.print(table, width=200)
    printed = capsys.readouterr()
    for shown in (printed.out, printed.err):
        assert "".join(HOSTILE.split()) in "".join(shown.split())  # a title is broken to the width of its table
        assert "end" in shown
        assert all(letter.isprintable() or letter == "\n" for letter in shown)
