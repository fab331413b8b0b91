"""What a lab is asked for: the steps, and the config in place of the recordings' own."""

import json
from collections.abc import Sequence
from dataclasses import dataclass

from rotorrig.rig import ConfigError, short_hash
from rotorrig.rig.config import RigConfig

STEPS = ("track", "identify", "diagnose", "report")
USUAL_STEPS = ("track", "identify")


@dataclass(frozen=True, slots=True, kw_only=True)
class LabSettings:
    """Steps to do with every recording, in the order of `STEPS`, and the config in place of its own."""

    steps: tuple[str, ...] = USUAL_STEPS
    config: RigConfig | None = None  # None: every recording's own

    @classmethod
    def read(cls, text: str, *, config: RigConfig | None = None, where: str = "--steps") -> "LabSettings":
        """Read steps from "track,identify". Raises ConfigError unless every one is known and begins with track."""
        asked = [word.strip() for word in text.split(",")]
        unknown = [word for word in asked if word not in STEPS]
        if unknown:
            raise ConfigError(f"{where}: got '{unknown[0]}', want some of {','.join(STEPS)}")
        if "track" not in asked:
            raise ConfigError(f"{where}: got '{text}', want track among them, which all others need")
        return cls(steps=tuple(step for step in STEPS if step in asked), config=config)

    @property
    def config_hash(self) -> str:
        """Hash of the config given; empty: a recording's own, which its bytes determine."""
        return self.config.hash if self.config else ""

    def key(self, run_id: str, *, code_version: str, steps: Sequence[str] | None = None) -> str:
        """Return the key of a computation: 16 hex digits that change with whatever may change its result."""
        parts = [run_id, self.config_hash, code_version, list(steps or self.steps), {}]  # no settings but defaults yet
        return short_hash(json.dumps(parts).encode())
