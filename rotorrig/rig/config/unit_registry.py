"""The unit registry, with its parsed definitions kept between runs: parsing them takes half a second.

pint writes its cache in place, so of programs that start at once on a fresh account one may read what another has
half written. Here a cache is made in a folder of its own and renamed into place: what stands there is complete. One
that cannot be read or written, for whatever reason, is done without.
"""

import contextlib
import functools
import hashlib
import os
import re
import shutil
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pint


@functools.cache
def registry() -> "pint.UnitRegistry":
    """Return the one unit registry, made on first use: our own files, in SI, do not need it."""
    try:
        return _load_cached(_folder())
    except Exception:  # a home that is missing, full or read-only; a cache of which a disk has lost a part
        return _registry(None)


def _registry(cache: Path | None) -> "pint.UnitRegistry":
    import pint

    return pint.UnitRegistry(cache_folder=cache, preprocessors=[_use_field_names])


def _use_field_names(text: str) -> str:
    """Return `text` with the field's mil, a thousandth of an inch, under pint's name for it: pint's mil is an angle."""
    return re.sub(r"\bmils?\b", "thou", text)


def _load_cached(folder: Path) -> "pint.UnitRegistry":
    """Return the registry from the cache in `folder`, which is made if there is none."""
    if folder.is_dir():
        return _registry(folder)
    folder.parent.mkdir(parents=True, exist_ok=True)
    private = Path(tempfile.mkdtemp(dir=folder.parent))
    try:
        made = _registry(private)
        with contextlib.suppress(OSError):  # another program was first
            private.rename(folder)
    finally:
        shutil.rmtree(private, ignore_errors=True)
    return made


def _folder() -> Path:
    """Return the folder of the cache: one for every pint and Python, so that what is in it never has to be replaced."""
    import pint

    home = os.environ.get("XDG_CACHE_HOME")
    definitions = sorted(Path(pint.__file__).parent.glob("*.txt"))
    made_of = [pint.__version__, sys.version, *(f"{path} {path.stat().st_mtime_ns}" for path in definitions)]
    name = hashlib.sha256("\n".join(made_of).encode()).hexdigest()[:16]
    return (Path(home) if home else Path.home() / ".cache") / "rotorrig" / f"units-{name}"
