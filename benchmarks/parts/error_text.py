"""An exception as it is kept with the result of a case."""

import traceback
from pathlib import Path

ROOT = Path(__file__).parents[2]


def error_text() -> str:
    """Return the exception under way with its traceback; paths are relative to the project's root."""
    return traceback.format_exc().replace(f"{ROOT}/", "")
