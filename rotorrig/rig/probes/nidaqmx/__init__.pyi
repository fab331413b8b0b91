from .daq import NiDaqmxDaq as NiDaqmxDaq

__all__ = ["NiDaqmxDaq"]
