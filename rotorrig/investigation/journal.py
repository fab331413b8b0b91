"""`investigation.json`: the runs made so far, why each was made, and what was believed after it."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from rotorrig.identify import Verdict
from rotorrig.identify.result_files import INVESTIGATION, read_table, write_table
from rotorrig.investigation.beliefs import Belief
from rotorrig.rig import DataError, Provenance


@dataclass(frozen=True, slots=True, kw_only=True)
class Round:
    """One run: chosen, made, and judged together with those before it."""

    number: int  # in the names of its files: run-1.mcap, response-1.mcap, diagnosis-1.json
    plan: str  # of the config
    trial: tuple[str, ...]  # masses on the rotor, "disk: 12 g mm at 90 deg"
    why: str  # it was made
    unseen: bool  # it was made to measure a gain on what no fit has seen
    joined: bool = False  # it did not bear the cause out, and was fitted with the others
    speeds: tuple[float, ...] = ()  # rad/s, that were held instead of those of the plan
    seconds: float = 0.0  # recorded; 0: not made yet
    verdict: Verdict | None = None  # None: not diagnosed yet
    sentence: str = ""
    beliefs: tuple[Belief, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Journal:
    """An investigation so far."""

    config_hash: str  # of the config with its menu of runs
    rounds: tuple[Round, ...] = ()
    ending: str = ""  # why no run follows; empty: it goes on

    @property
    def judged(self) -> tuple[Round, ...]:
        """The rounds that are through."""
        return tuple(each for each in self.rounds if each.verdict is not None)

    @property
    def mounted(self) -> tuple[str, ...]:
        """The trial masses that should be on the rotor: those of the last run."""
        return self.rounds[-1].trial if self.rounds else ()

    @property
    def seconds(self) -> float:
        """Recorded so far."""
        return sum(each.seconds for each in self.rounds)

    def with_last(self, **changes: Any) -> "Journal":
        """Return it with its last round changed."""
        return replace(self, rounds=(*self.rounds[:-1], replace(self.rounds[-1], **changes)))


def write_journal(path: Path, journal: Journal, source: Provenance) -> None:
    """Write investigation.json, whole or not at all. Raises DataError."""
    body = {"config": journal.config_hash, "rounds": [asdict(each) for each in journal.rounds]}
    write_table(path, INVESTIGATION, {**body, "ending": journal.ending}, source)


def read_journal(path: Path) -> Journal:
    """Read investigation.json. Raises DataError naming the file if it is not one."""
    table = read_table(path, INVESTIGATION)
    try:
        return Journal(
            config_hash=table["config"],
            rounds=tuple(_round(each) for each in table["rounds"]),
            ending=table["ending"],
        )
    except (KeyError, TypeError, ValueError) as error:
        raise DataError(f"{path}: is no whole investigation ({error}), want one of rotor investigate") from error


def _round(table: dict[str, Any]) -> Round:
    return Round(
        **{key: table[key] for key in ("number", "plan", "why", "unseen", "joined", "seconds", "sentence")},
        trial=_texts(table["trial"]),
        speeds=tuple(float(speed) for speed in table.get("speeds", ())),
        verdict=None if table["verdict"] is None else Verdict(table["verdict"]),
        beliefs=tuple(Belief(each["label"], float(each["probability"])) for each in table["beliefs"]),
    )


def _texts(values: Sequence[Any]) -> tuple[str, ...]:
    return tuple(str(value) for value in values)
