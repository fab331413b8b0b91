"""Units in which pages, pictures and tables tell amplitudes: as stated, or as a lab reads them."""

import re
from dataclasses import dataclass

from rotorrig.rig import DataError
from rotorrig.rig.config import UM

AMPLITUDE_UNITS = (
    "µm 0-peak",
    "µm pp",
    "mil pp",
    "mil 0-peak",
)  # those of unit-choice.js, the first as pages are written

MIL = 25.4e-6  # m
STATED = re.compile(r"(\d[\d.]*)( ± | to )?(\d[\d.]*)?[ \u00a0][uµ]m 0-peak")  # as sentences have it; units.js too


@dataclass(frozen=True, slots=True)
class AmplitudeUnit:
    """A unit of AMPLITUDE_UNITS, and that of lengths beside it: a place or an orbit is neither 0-peak nor pp."""

    name: str = AMPLITUDE_UNITS[0]

    @property
    def by(self) -> float:
        """What an amplitude [m, 0-peak] is multiplied by."""
        return amplitude_factor(self.name)

    @property
    def length(self) -> str:
        """The unit of a length, "µm" or "mil"."""
        return self.name.split()[0]

    @property
    def way(self) -> str:
        """How an amplitude is counted, "0-peak" or "pp"."""
        return self.name.split()[1]

    @property
    def by_length(self) -> float:
        """What a length [m] is multiplied by."""
        return 1 / MIL if self.length == "mil" else UM

    def retell(self, words: str) -> str:
        """Return a sentence with its amplitudes in this unit, to as many digits, two at least.

        >>> AmplitudeUnit("mil pp").retell("off by 12.7 um 0-peak, 31 %")
        'off by 1.00 mil pp, 31 %'
        >>> AmplitudeUnit("mil pp").retell("goes from 5.2 to 0.41 um 0-peak")
        'goes from 0.41 to 0.032 mil pp'
        """
        return STATED.sub(self._retell_one, words)

    def _retell_one(self, found: "re.Match[str]") -> str:
        value, between, other = found.groups(default="")  # its sigma, or what it goes to
        return f"{self._figure(value)}{between}{self._figure(other)} {self.name}"

    def _figure(self, digits: str) -> str:
        if not digits:
            return ""
        kept = max(len(digits.replace(".", "").lstrip("0")), 2)
        return f"{float(digits) / UM * self.by:#.{kept}g}".rstrip(".")


AS_STATED = AmplitudeUnit()


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
