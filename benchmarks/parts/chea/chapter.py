"""The rows the chapter prints in its Tables 2 to 4, for benchmarks/chea_tables.py."""

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class Printed:
    """A printed row; None where the chapter is silent."""

    calls: int
    fun: float  # of eq. (3) with the sign turned
    x: tuple[float, float]
    success: float | None = None  # part of the runs
    minima: int  # rows printed
    all_globals: float | None = None


#: method -> function -> row. Of Table 3 the first row; the signs of its other rows repeat, where they must differ.
CHAPTER = {
    "CHEA": {
        "f1": Printed(calls=1120, fun=9.94e-13, x=(1.0, 1.0), minima=1),
        "f2": Printed(calls=1131, fun=-16.09172, x=(-0.43880, -0.30585), minima=4, all_globals=1.0),
        "f3": Printed(calls=2100, fun=1.57e-11, x=(-5.72e-9, -2.81e-7), success=0.99, minima=4, all_globals=0.99),
    },
    "EGA": {
        "f1": Printed(calls=3183, fun=6.06e-19, x=(0.9999, 1.0), minima=1),
        "f2": Printed(calls=3014, fun=-16.09172, x=(-0.43880, -0.30585), minima=4, all_globals=1.0),
        "f3": Printed(calls=3131, fun=3.16e-13, x=(1e-20, 1e-20), success=0.85, minima=1, all_globals=0.85),
    },
    "ASA": {
        "f1": Printed(calls=1414, fun=0.0905, x=(0.6995, 0.4878), minima=1),
        "f2": Printed(calls=1391, fun=-16.09172, x=(0.43881, -0.30585), minima=1, all_globals=0.0),
        "f3": Printed(calls=1336, fun=-2.55e-7, x=(1.82e-5, -2.55e-6), success=0.83, minima=1, all_globals=0.83),
    },
}
