from .daq import OpenDaqDaq as OpenDaqDaq

__all__ = ["OpenDaqDaq"]
