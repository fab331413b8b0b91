from .daq import StreamDaq as StreamDaq

__all__ = ["StreamDaq"]
