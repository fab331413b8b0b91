"""Provenance of a file: hashes of its inputs and the version of the code."""

import hashlib
import subprocess
from dataclasses import dataclass
from functools import cache
from importlib import metadata
from pathlib import Path


@dataclass(frozen=True, slots=True, kw_only=True)
class Provenance:
    """Inputs and code version of a result; every file this program writes carries one."""

    config_hash: str  # sha256 of the checked config, first 16 hex digits
    code_version: str  # package version, with the commit where there is one
    source: str = ""  # the file or device the data came from
    source_hash: str = ""  # sha256 of that file, first 16 hex digits; empty for a live rig


def short_hash(data: bytes) -> str:
    """Return the first 16 hex digits of the sha256 of `data`."""
    return hashlib.sha256(data).hexdigest()[:16]


def file_hash(path: Path) -> str:
    """Return the first 16 hex digits of the sha256 of a file, read in pieces."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()[:16]


@cache
def code_version() -> str:
    """Return the package version, with "+<commit>" and ".dirty" appended in a git checkout."""
    version = metadata.version("rotorrig")
    root = Path(__file__).parents[2]
    if not (root / ".git").exists():
        return version
    commit = _git(root, "rev-parse", "--short", "HEAD")
    if not commit:
        return version
    return f"{version}+{commit}" + (".dirty" if _git(root, "status", "--porcelain", "-uno") else "")


def _git(root: Path, *words: str) -> str:
    try:
        done = subprocess.run(["git", "-C", str(root), *words], capture_output=True, text=True, timeout=5)
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return done.stdout.strip() if done.returncode == 0 else ""
