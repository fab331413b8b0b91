from .pipeline import track as track
from .probe_planes import Plane as Plane
from .probe_planes import measured_planes as measured_planes
from .probe_planes import planes as planes
from .probe_planes import whirl as whirl
from .resonance import Resonance as Resonance
from .resonance import Uncertain as Uncertain
from .resonance import find_resonances as find_resonances
from .resonance import required_margin as required_margin
from .response import OrderTrackedResponse as OrderTrackedResponse
from .response import Run as Run
from .response import require_phases as require_phases
from .settings import Spacing as Spacing
from .settings import SpeedWindow as SpeedWindow
from .settings import Tracking as Tracking
from .settings import read_orders as read_orders
from .waveform import Waveforms as Waveforms

__all__ = [
    "OrderTrackedResponse",
    "Plane",
    "Resonance",
    "Run",
    "Spacing",
    "SpeedWindow",
    "Tracking",
    "Uncertain",
    "Waveforms",
    "find_resonances",
    "measured_planes",
    "planes",
    "read_orders",
    "require_phases",
    "required_margin",
    "track",
    "whirl",
]
