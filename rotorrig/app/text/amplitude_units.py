"""Units in which pages and tables tell amplitudes: as stated, or as a lab reads them."""

from rotorrig.rig import DataError
from rotorrig.rig.config import UM

AMPLITUDE_UNITS = (
    "µm 0-peak",
    "µm pp",
    "mil pp",
    "mil 0-peak",
)  # those of unit-choice.js, the first as pages are written

MIL = 25.4e-6  # m


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


def amplitude_factor(unit: str) -> float:
    """Return by what an amplitude [m, 0-peak] is multiplied to be told in a unit of AMPLITUDE_UNITS.

    >>> amplitude_factor("µm pp"), round(amplitude_factor("mil 0-peak") * 1e-6, 6)
    (2000000.0, 0.03937)
    """
    length, way = unit.split()
    return (1 / MIL if length == "mil" else UM) * (2 if way == "pp" else 1)
