"""Order tracking by angular resampling, harmonic least squares or Vold-Kalman; full spectrum, synchronous waveform."""

from rotorrig.processing.tracking.full_spectrum import HIGHEST, WhirlVectors, full_spectrum, whirl_vectors
from rotorrig.processing.tracking.methods import METHODS, NoiseResponse, TrackingMethod
from rotorrig.processing.tracking.synchronous_waveform import first_point, row_waveform
from rotorrig.processing.tracking.vold_kalman import support

__all__ = [
    "HIGHEST",
    "METHODS",
    "NoiseResponse",
    "TrackingMethod",
    "WhirlVectors",
    "first_point",
    "full_spectrum",
    "row_waveform",
    "support",
    "whirl_vectors",
]
