"""Parts of the live view, one file each: orbits, vectors, position, cascade, readings, and the fixed layout."""

from rotorrig.app.viewer.live.parts.blueprint import live_blueprint, replay_blueprint
from rotorrig.app.viewer.live.parts.scene import LiveScene

__all__ = [
    "LiveScene",
    "live_blueprint",
    "replay_blueprint",
]
