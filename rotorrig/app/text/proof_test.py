"""Proof test of a config in a sentence: what a sweep says where there is none, or it does not hold."""

from pathlib import Path

from rotorrig.acquisition.proof_test import certificate_file, read_certificate
from rotorrig.rig import DataError
from rotorrig.rig.config import RigConfig


def proof_test_remark(rig: RigConfig, config: Path) -> str:
    """Return what is to be said of the certificate of the config that was given so; empty: it holds."""
    path = certificate_file(config)
    want = f"rotor check {config} --proof-test"
    if not path.is_file():
        return f"no proof test of this rig's protections; {want} makes one"
    try:
        certificate = read_certificate(path)
    except DataError as error:
        return str(error)
    if certificate.simulated:
        return f"{path}: is of a simulated rig; {want} tests the protections of this one"
    if certificate.config_hash != rig.hash:
        return f"{path}: the proof test of {certificate.date:%Y-%m-%d} is older than the config; {want} --force"
    if certificate.failed:
        return f"{path}: not proven on {certificate.date:%Y-%m-%d}: {', '.join(certificate.failed)}; {want} --force"
    return ""
