"""The live view, a process of its own.

Blocks come through a pipe, are tracked and drawn; a hung viewer never stops a sweep.
"""

from rotorrig.app.viewer.live.process import open_stream
from rotorrig.app.viewer.live.view import LiveView

__all__ = [
    "LiveView",
    "open_stream",
]
