"""Let one process of a test run compile a numba kernel: the others wait for it and load it from numba's cache.

The cache has no lock of its own. Without one, every worker compiles what the first tests need, all at the same time.
"""

import fcntl
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from numba.core.compiler_lock import global_compiler_lock
from numba.core.dispatcher import Dispatcher

_compile = Dispatcher.compile
_held: set[Path] = set()  # by this process; numba lets one thread at a time compile


def compile_once(kernel: Any, signature: Any) -> Any:
    """Compile or load a kernel while no other process does."""
    with global_compiler_lock, _lock(kernel):
        return _compile(kernel, signature)


@contextmanager
def _lock(kernel: Any) -> Iterator[None]:
    folder = kernel._cache.cache_path
    path = folder and Path(folder, f"{kernel.__module__}.{kernel.__qualname__}.lock")
    if path is None or path in _held:  # not kept, or on the way to another signature of it
        yield
        return
    with path.open("a") as file:
        fcntl.flock(file, fcntl.LOCK_EX)  # kernels call one another one way: who holds one waits for its callees alone
        _held.add(path)
        try:
            yield
        finally:
            _held.remove(path)


def install() -> None:
    """Let numba compile so in this process."""
    Dispatcher.compile = compile_once
