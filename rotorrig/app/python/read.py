"""Files read by their content: what this program writes, and what others do."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from rotorrig.acquisition.files import KINDS, content_kind
from rotorrig.app.python.balancing import Balance
from rotorrig.app.python.recording import Recording
from rotorrig.app.python.response import Response
from rotorrig.app.python.results import Diagnosis, Identification
from rotorrig.app.python.rotor import Rotor
from rotorrig.balancing import read_balance
from rotorrig.identify import read_diagnosis, read_identification
from rotorrig.processing.files import read_response, read_table
from rotorrig.rig import DataError
from rotorrig.rig.config import find_config, load


def read(path: str | Path, *, config: str | Path | None = None, mapping: str | Path | None = None) -> Any:
    """Return what a file holds, a `Recording`, `Response`, `Identification`, `Diagnosis`, `Balance`, `Rotor`, journal.

    A table of vectors of another program (CSV) wants the rig's `config` and the `mapping` of its columns, as `rotor
    import` does, and becomes a `Response`. Waveforms of other programs (CSV, UFF, TDMS, WAV) want `config`, and a
    mapping where channels are not named as in the config; they become a `RawRecording`, which `rr.track` takes.
    Raises DataError, ConfigError.
    """
    path = Path(path)
    if not path.exists():
        raise DataError(f"{path}: is not there, want a file of this program or of one it imports")
    if path.is_dir():
        raise DataError(f"{path}: is a folder, want a file")
    if config is not None:
        return _read_foreign(path, Path(config), Path(mapping) if mapping else None)
    kind = content_kind(path)
    if kind == "investigation":
        from rotorrig.investigation import read_journal

        return read_journal(path)
    readers: dict[str, Callable[[Path], Any]] = {
        "run": Recording,
        "response": lambda file: Response.of(read_response(file)),
        "fit": lambda file: Identification.of(read_identification(file)),
        "balance": lambda file: Balance.of(read_balance(file)),
        "diagnosis": lambda file: Diagnosis.of(read_diagnosis(file)),
        "config": Rotor.from_config,
        "ross": Rotor.from_ross,
    }
    if kind not in readers:
        raise DataError(
            f"{path}: is {KINDS[kind]}, which is not read as it is; a table or waveforms of another program want "
            "config=, the rig's TOML file"
        )
    return readers[kind](path)


def _read_foreign(path: Path, config: Path, mapping: Path | None) -> Any:
    from rotorrig.app.commands.other_programs import import_files

    rig = load(find_config(config))
    if mapping is not None and import_files.kind_made(mapping) == "response":
        return Response.of(read_table(path, mapping, rig))
    return import_files.read_waveforms(path, rig, mapping)
