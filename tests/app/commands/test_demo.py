"""The demo's last step: a named cause goes into the model, and the run is judged again."""

import dataclasses
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest

from rotorrig.app.commands import demo
from rotorrig.app.commands import diagnose as diagnosing
from rotorrig.identify.diagnosis import Diagnosis, Verdict
from rotorrig.identify.result_files import read_diagnosis
from rotorrig.processing.files.response_mcap import write_response
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.config.description import load


def test_a_run_is_diagnosed_again_with_the_cause_that_was_named(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, response: OrderTrackedResponse, named: Diagnosis, good: Diagnosis
) -> None:
    judged: list[tuple[str, ...]] = []

    def diagnose(responses: Sequence[OrderTrackedResponse], **more: Any) -> Diagnosis:
        judged.append(tuple(effect.label for effect in responses[0].rig.effects))
        return good

    monkeypatch.setattr(diagnosing, "diagnose", diagnose)
    write_response(tmp_path / "response.mcap", response)
    bowed = demo.cases(1)[1]
    demo.extend(response.rig, bowed, tmp_path, named)
    assert judged == [("bow",)]
    assert [effect.label for effect in load(tmp_path / "extended.toml").effects] == ["bow"]
    assert read_diagnosis(tmp_path / "diagnosis-extended.json").verdict is Verdict.ADEQUATE


def test_with_nothing_named_nothing_is_extended(
    tmp_path: Path, response: OrderTrackedResponse, named: Diagnosis
) -> None:
    nothing = dataclasses.replace(named, causes=named.causes[1:])
    demo.extend(response.rig, demo.cases(1)[0], tmp_path, nothing)
    assert list(tmp_path.iterdir()) == []
