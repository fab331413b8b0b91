"""`Rotor`: the finite-element rotor of a config, and its way to ROSS and back."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Self

import numpy as np
from numpy.typing import NDArray

from rotorrig.app.python.card import Card, Shown
from rotorrig.rig import DataError, write_whole_text
from rotorrig.rig.config import RPM, RigConfig, find_config, load, parse
from rotorrig.rig.ross import config_text, read_ross, ross_rotor, ross_text

if TYPE_CHECKING:
    from rotorrig.sims.rotor.model import RotorModel

MAX_ELEMENT = 0.02  # m, of a rotor for ROSS


class Rotor(Shown):
    """The nameplate rotor of a rig; effects in its config are no part of it."""

    def __init__(self, rig: RigConfig) -> None:
        """Take a rig's config."""
        from rotorrig.sims.rotor.model import assemble

        self.rig = rig
        self.model: RotorModel = assemble(rig)

    @classmethod
    def from_config(cls, config: str | Path) -> Self:
        """Return the rotor of a TOML file, or of a bundled config by its name. Raises ConfigError."""
        return cls(load(find_config(Path(config))))

    @classmethod
    def from_ross(cls, path: str | Path) -> Self:
        """Return a rotor saved by ROSS; its probes are placeholders. Raises ConfigError."""
        text = config_text(read_ross(Path(path)), name=Path(path).stem, source=Path(path).name)
        return cls(parse(text, where=f"{path}, as a config"))

    def to_ross(self, path: str | Path) -> Path:
        """Write the rotor as ROSS's `Rotor.load` reads it. Raises ConfigError for what ROSS does not have."""
        from rotorrig.sims.rotor.model import assemble

        rotor = ross_rotor(self.rig, nodes=assemble(self.rig, max_element=MAX_ELEMENT).z.tolist())
        write_whole_text(Path(path), ross_text(rotor, source=self.rig.name))
        return Path(path)

    def save(self, path: str | Path) -> Path:
        """Write the config as TOML. Raises DataError if it cannot be written."""
        write_whole_text(Path(path), self.rig.text)
        return Path(path)

    def critical_speeds(self, *, up_to_rpm: float) -> NDArray[np.float64]:
        """Return the damped 1X critical speeds [rpm] up to a speed, by the eigenvalues of the model."""
        from rotorrig.sims.rotor.modes import critical_speeds

        return np.asarray(critical_speeds(self.model, up_to=up_to_rpm / RPM)) * RPM

    def unbalance_response(self, rpm: Sequence[float], unbalance: Mapping[str, complex]) -> NDArray[np.complex128]:
        """Return the steady 1X vectors (speed, probe) [m, 0-peak] for unbalances by disk or plane.

        An unbalance is U e^{j phi} [kg m], phi from the keyphasor mark in the sense of rotation; the phase lag of a
        vector z is -arg z. Raises DataError for a plane that the rig does not have.
        """
        from rotorrig.sims.rotor.steady import probe_response

        planes = self.rig.unbalance_planes
        if strange := [name for name in unbalance if name not in planes]:
            raise DataError(
                f"unbalance: '{strange[0]}' is no plane of {self.rig.name}, want one of {', '.join(planes)}"
            )
        return probe_response(self.model, np.asarray(rpm, dtype=float) / RPM, unbalance=dict(unbalance))

    @property
    def _card(self) -> Card:
        rig = self.rig
        lines = [
            ("shaft", f"{1e3 * rig.shaft.length:.0f} mm"),
            ("disks", ", ".join(f"{disk.name} at {1e3 * disk.position:.0f} mm" for disk in rig.disks)),
            ("bearings", ", ".join(f"{bearing.name} at {1e3 * bearing.position:.0f} mm" for bearing in rig.bearings)),
            ("probes", ", ".join(f"{probe.name} at {1e3 * probe.position:.0f} mm" for probe in rig.probes)),
            ("rotation", rig.rotation),
        ]
        return Card(f"Rotor of {rig.name}", lines)
