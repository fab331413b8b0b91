"""Units of foreign files: "mV", "Volts", "µm", "127 um" to volts or metres."""

from rotorrig.rig.config import to_si


def signal_factor(text: str, *, length: bool) -> tuple[float, bool] | None:
    """Return the value of a unit in V or m, and whether it is a length; None if it is neither.

    With `length` False only a voltage is accepted. Programs spell units in many ways, so "Volts" and "MIL" are read as
    "volts" and "mil"; capitals count in short ones, where they tell M from m.

    >>> signal_factor("2 mV", length=True), signal_factor("1 MIL", length=True), signal_factor("1 kg", length=True)
    ((0.002, False), (2.54e-05, True), None)
    """
    words = text.split()
    spellings = [text]
    if words and len(words[-1]) > 2:
        spellings.append(" ".join([*words[:-1], words[-1].lower()]))
    for spelling in spellings:
        for quantity in ("voltage", "length") if length else ("voltage",):
            try:
                return to_si(spelling, quantity), quantity == "length"
            except ValueError:
                continue
    return None
