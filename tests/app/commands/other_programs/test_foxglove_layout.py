"""The layout for Foxglove: every path names a topic and a numeric field of the file, every panel has its place."""

import json
from pathlib import Path
from typing import Any

import pytest
from google.protobuf import descriptor_pb2
from mcap.reader import make_reader

from rotorrig.app.commands.other_programs import foxglove_layout
from rotorrig.app.commands.other_programs.export_files import write_out
from rotorrig.processing.files.response_mcap import write_response
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.errors import DataError

NUMBERS = {descriptor_pb2.FieldDescriptorProto.TYPE_DOUBLE, descriptor_pb2.FieldDescriptorProto.TYPE_INT64}


def numeric_fields(path: Path) -> set[str]:
    """Return "topic.field" of every number in a file, by the file's own descriptors."""
    with path.open("rb") as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    found = set()
    for channel in summary.channels.values():
        schema = summary.schemas[channel.schema_id]
        for part in descriptor_pb2.FileDescriptorSet.FromString(schema.data).file:
            for message in part.message_type:
                if f"{part.package}.{message.name}" == schema.name:
                    found |= {f"{channel.topic}.{field.name}" for field in message.field if field.type in NUMBERS}
    return found


def panels_of(node: Any) -> list[str]:
    return [node] if isinstance(node, str) else [*panels_of(node["first"]), *panels_of(node["second"])]


def test_every_path_names_a_number_of_the_file_and_every_panel_has_one_place(
    tmp_path: Path, response: OrderTrackedResponse
) -> None:
    write_response(tmp_path / "response.mcap", response)
    there = numeric_fields(tmp_path / "response.mcap")
    layout = foxglove_layout(response)
    plots = [config for name, config in layout["configById"].items() if name.startswith("Plot!")]
    paths = {path["value"] for plot in plots for path in (*plot["paths"], plot["xAxisPath"])}
    assert len(paths) > 20
    assert paths <= there
    assert all(plot["xAxisPath"]["value"].endswith(".exact_speed_rpm") for plot in plots)
    assert sorted(panels_of(layout["layout"])) == sorted(layout["configById"])


def test_a_response_is_exported_as_a_layout_and_a_run_is_not(tmp_path: Path, response: OrderTrackedResponse) -> None:
    write_response(tmp_path / "response.mcap", response)
    said = write_out(tmp_path / "response.mcap", tmp_path / "layout.json")
    assert "panels for Foxglove" in said
    assert json.loads((tmp_path / "layout.json").read_text()) == foxglove_layout(response)
    recorded = Path(__file__).parents[3] / "data" / "recording-v1" / "run.mcap"
    with pytest.raises(DataError, match="a layout needs a response"):
        write_out(recorded, tmp_path / "run.json")
