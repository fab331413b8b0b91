"""A mapping from its text."""

from collections.abc import Callable
from pathlib import Path

import pytest

from rotorrig.acquisition.importers.channel_mapping import ChannelMapping, load_channels
from rotorrig.rig.config.description import RigConfig


@pytest.fixture
def mapping(tmp_path: Path, rig: RigConfig) -> Callable[[str], ChannelMapping]:
    def make(text: str) -> ChannelMapping:
        path = tmp_path / "mapping.toml"
        path.write_text(text)
        return load_channels(path, rig)

    return make
