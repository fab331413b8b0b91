from .pipeline import track as track
from .probe_planes import Plane as Plane
from .probe_planes import measured_planes as measured_planes
from .probe_planes import planes as planes
from .probe_planes import whirl as whirl
from .response import OrderTrackedResponse as OrderTrackedResponse
from .response import Run as Run
from .settings import Spacing as Spacing
from .settings import SpeedWindow as SpeedWindow
from .settings import Tracking as Tracking
from .settings import read_orders as read_orders
from .waveform import Waveforms as Waveforms

__all__ = [
    "OrderTrackedResponse",
    "Plane",
    "Run",
    "Spacing",
    "SpeedWindow",
    "Tracking",
    "Waveforms",
    "measured_planes",
    "planes",
    "read_orders",
    "track",
    "whirl",
]
