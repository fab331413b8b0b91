"""What a sweep says of the proof test of its config."""

import math
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

import pytest

from rotorrig.acquisition.proof_test import Certificate, Proof, Verdict, read_certificate, write_certificate
from rotorrig.app.text import proof_test_remark
from rotorrig.rig.config.description import load
from rotorrig.rig.errors import DataError

RK4 = Path(__file__).parents[3] / "configs/rk4.toml"
PASSED = Proof(
    name="overspeed", provocation="limit lowered", verdict=Verdict.PASSED, decided_after=0.02, rest_after=2.5
)
NONE = Proof(name="watchdog", provocation="silence", verdict=Verdict.NOT_AVAILABLE, why="the drive has no watchdog")


@pytest.fixture
def config(tmp_path: Path) -> Path:
    path = tmp_path / "lab.toml"
    path.write_text(RK4.read_text())
    return path


@pytest.fixture
def certificate(config: Path) -> Certificate:
    return Certificate(
        date=datetime(2026, 11, 22, 21, 30, tzinfo=UTC),
        rig="RK4",
        config_hash=load(config).hash,
        code_version="0.1.0",
        simulated=False,
        drive="PowerFlex 400",
        drive_link="Modbus RTU",
        drive_watchdog=None,
        daq="board, serial 7",
        speed=25.0,
        proofs=(PASSED, NONE),
    )


def remark(config: Path, certificate: Certificate | None = None) -> str:
    if certificate:
        write_certificate(config.with_name("lab.proof.json"), certificate)
    return proof_test_remark(load(config), config)


def test_a_certificate_that_holds_is_not_mentioned(config: Path, certificate: Certificate) -> None:
    assert remark(config, certificate) == ""


def test_none_is_said_with_the_command_that_makes_one(config: Path) -> None:
    assert remark(config) == f"no proof test of this rig's protections; rotor check {config} --proof-test makes one"


def test_a_config_that_has_changed_since_is_said(config: Path, certificate: Certificate) -> None:
    remark(config, certificate)
    config.write_text(RK4.read_text().replace('overspeed = "4000 rpm"', 'overspeed = "3900 rpm"'))
    assert "the proof test of 2026-11-22 is older than the config" in remark(config)


def test_comments_and_order_do_not_make_a_certificate_old(config: Path, certificate: Certificate) -> None:
    remark(config, certificate)
    config.write_text("# moved to the other room\n" + RK4.read_text())
    assert remark(config) == ""


def test_what_failed_is_said(config: Path, certificate: Certificate) -> None:
    failed = replace(PASSED, name="watchdog", verdict=Verdict.FAILED, why="as before")
    untested = replace(PASSED, name="link loss", verdict=Verdict.NOT_TESTED)
    assert "not proven on 2026-11-22: watchdog, link loss" in remark(
        config, replace(certificate, proofs=(PASSED, failed, untested))
    )


def test_a_simulated_rigs_certificate_is_none_of_this_one(config: Path, certificate: Certificate) -> None:
    assert "is of a simulated rig" in remark(config, replace(certificate, simulated=True))


@pytest.mark.parametrize(
    "text", ["", "[]", "{}", '{"kind": "rotorrig proof test", "version": 2}', "\xff", "[" * 100_000]
)
def test_another_file_of_that_name_is_said_in_a_sentence(config: Path, text: str) -> None:
    config.with_name("lab.proof.json").write_text(text, encoding="latin-1")
    assert "is no certificate of version 1" in remark(config)


def test_a_certificate_is_read_as_it_was_written(config: Path, certificate: Certificate) -> None:
    remark(config, certificate)
    back = read_certificate(config.with_name("lab.proof.json"))
    assert replace(back, proofs=()) == replace(certificate, proofs=())
    first = back.proofs[0]
    assert (first.decided_after, first.rest_after) == (0.02, 2.5)
    assert math.isnan(first.slowing_after)
    assert back.passed and back.failed == ()
    with pytest.raises(DataError, match="cannot be read"):
        read_certificate(config.with_name("other.json"))
