from pathlib import Path

import pytest
from mcap.reader import make_reader

from rotorrig.acquisition.files.container import FileKind, read_file
from rotorrig.acquisition.files.file_writer import FileWriter
from rotorrig.acquisition.files.schemas import message_type
from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.provenance import Provenance


def test_a_derived_file_is_discarded_when_its_writing_fails(rig: RigConfig, source: Provenance, tmp_path: Path) -> None:
    path = tmp_path / "response.mcap"
    path.write_bytes(b"the one before")
    kind = FileKind(name="response", version=1, remedy="`rotor track` makes it again")
    with pytest.raises(ZeroDivisionError), FileWriter(path, kind=kind, rig=rig, source=source):
        raise ZeroDivisionError
    assert path.read_bytes() == b"the one before"
    assert list(tmp_path.iterdir()) == [path]


def test_messages_of_many_topics_share_a_schema_and_keep_their_order(
    rig: RigConfig, source: Provenance, tmp_path: Path
) -> None:
    path = tmp_path / "response.mcap"
    kind = FileKind(name="response", version=1, remedy="")
    row = message_type("TestRow", {"speed_rpm": "int64", "amplitude_um": "double"})
    with FileWriter(path, kind=kind, rig=rig, source=source) as file:
        for i in range(10):
            for topic in ("/bode/1x", "/bode/1y"):
                file.write(topic, row, 1000 * i, speed_rpm=i, amplitude_um=i / 2)
    contents = read_file(path, kind=kind, types=(row,))
    assert [(m.topic, m.t_ns, m.values.speed_rpm, m.values.amplitude_um) for m in contents.messages[:3]] == [
        ("/bode/1x", 0, 0, 0.0),
        ("/bode/1y", 0, 0, 0.0),
        ("/bode/1x", 1000, 1, 0.5),
    ]
    assert contents.source == source
    with path.open("rb") as stream:
        summary = make_reader(stream).get_summary()
        assert summary is not None
        assert len(summary.schemas) == 1
