"""Terminal tables of balancing: corrections, vibration before and after, a run against its prediction."""

from rich import box
from rich.table import Table

from rotorrig.app.text import AMPLITUDE_UNITS, CONVENTION, comparison_rows, correction_rows, highest_rows
from rotorrig.balancing import Balance, Prediction


def corrections_table(balance: Balance) -> Table:
    """Return every correction with its 95 % interval, on 80 columns: mass and angle against rotation below."""
    table = Table(title=f"Correction: {CONVENTION}", box=box.SIMPLE_HEAD, title_justify="left")
    table.add_column("plane")
    table.add_column("by")
    for heading in ("amount", "angle"):
        table.add_column(heading, justify="right", no_wrap=True)
    for plane, by, amount, mass, angle, against in correction_rows(balance):
        weighed = f"{amount}\n{mass}" if plane in balance.radii else amount
        table.add_row(plane, by, weighed, f"{angle}\n{against} against rotation")
    return table


def prediction_table(prediction: Prediction, unit: str = AMPLITUDE_UNITS[0]) -> Table:
    """Return the largest amplitudes before and after, probe by probe, in a unit of AMPLITUDE_UNITS."""
    table = Table(title=f"Largest 1X amplitude, {unit}", box=box.SIMPLE_HEAD, title_justify="left")
    for heading in ("probe", "before", "predicted", "95 % band there"):
        table.add_column(heading, justify="left" if heading == "probe" else "right")
    for row in highest_rows(prediction, unit):
        table.add_row(row.probe, row.before, row.after, row.band)
    return table


def comparison_table(balance: Balance, unit: str = AMPLITUDE_UNITS[0]) -> Table:
    """Return how a run with the masses on compares with its prediction, probe by probe, in such a unit."""
    table = Table(title=f"The run after, {unit}", box=box.SIMPLE_HEAD, title_justify="left")
    for heading in ("probe", "inside 95 %", "largest measured", "largest predicted"):
        table.add_column(heading, justify="left" if heading == "probe" else "right")
    for row in comparison_rows(balance, unit):
        table.add_row(*row)
    return table
