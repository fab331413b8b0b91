"""`rotor import --ross` and `rotor export --ross`: ROSS rotors to configs and back."""

from pathlib import Path

from rotorrig.rig import write_whole_text
from rotorrig.rig.config import load, parse, read_quantity
from rotorrig.rig.ross import RossRotor, config_text, read_ross, ross_rotor, ross_text, sections


def bring_in(file: Path, *, out: Path, keep_nodes: bool) -> list[str]:
    """Write a config of the rotor in `file` and return its summary, notes first. Raises ConfigError."""
    rotor = read_ross(file)
    text = config_text(rotor, name=file.stem, source=file.name, keep_nodes=keep_nodes)
    parse(text, where=f"{file}, as a config")
    write_whole_text(out, text)
    made = f"{_count_parts(rotor)}, in {_count(len(sections(rotor, keep_nodes=keep_nodes)), 'section')}"
    return [*rotor.notes, f"{out}: {made}; its two probes are placeholders"]


def write_out(config: Path, *, out: Path, max_element: str) -> list[str]:
    """Write the rotor of a config for ROSS and return its summary, notes first. Raises ConfigError."""
    from rotorrig.sims.rotor.model import assemble

    rig = load(config)
    longest = read_quantity(max_element, "length", where="--max-element", positive=True)
    rotor = ross_rotor(rig, nodes=assemble(rig, max_element=longest).z.tolist())
    write_whole_text(out, ross_text(rotor, source=config.name))
    return [*rotor.notes, f"{out}: {_count_parts(rotor)}"]


def _count_parts(rotor: RossRotor) -> str:
    parts = ((rotor.shaft, "shaft element"), (rotor.disks, "disk"), (rotor.bearings, "bearing"))
    return ", ".join(_count(len(of_a_kind), noun) for of_a_kind, noun in parts)


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}{'s' * (number != 1)}"
