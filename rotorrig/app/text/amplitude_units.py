"""Units in which a page tells amplitudes: as stated, or as a lab reads them."""

from rotorrig.rig import DataError

AMPLITUDE_UNITS = ("µm 0-peak", "µm pp", "mil pp", "mil 0-peak")  # those of units.js, the first as pages are written


def read_amplitude_unit(text: str, *, where: str) -> str:
    """Return the unit of AMPLITUDE_UNITS that is meant. Raises DataError on any other.

    >>> read_amplitude_unit("um pp", where="--units"), read_amplitude_unit("mils  PP", where="--units")
    ('µm pp', 'mil pp')
    """
    length, *rest = text.lower().split() or [""]
    length = {"um": "µm", "\u03bcm": "µm", "micron": "µm", "microns": "µm", "mils": "mil"}.get(length, length)
    way = {"p-p": "pp", "pk-pk": "pp", "peak-to-peak": "pp", "pk": "0-peak", "0-pk": "0-peak"}
    unit = " ".join([length, *(way.get(word, word) for word in rest)])
    if unit not in AMPLITUDE_UNITS:
        raise DataError(f"{where}: got '{text}', want one of {', '.join(AMPLITUDE_UNITS)}")
    return unit
