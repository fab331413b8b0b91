"""SVG drawings of the report: the rig to scale, an orbit, a time base, a balancing plane."""

from rotorrig.app.report.drawings.mass_drawing import plane_drawing
from rotorrig.app.report.drawings.orbit_drawing import orbit_pictures
from rotorrig.app.report.drawings.rig_drawing import end_view, side_view
from rotorrig.app.report.drawings.time_base_drawing import time_base_picture

__all__ = [
    "end_view",
    "orbit_pictures",
    "plane_drawing",
    "side_view",
    "time_base_picture",
]
