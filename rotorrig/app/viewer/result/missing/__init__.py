"""What a model lacks, in the result view: words, the place along the shaft, the force over speed and over motion."""

from rotorrig.app.viewer.result.missing.draw import PATH, draw_missing

__all__ = [
    "PATH",
    "draw_missing",
]
