"""The response's file (MCAP) and its exchange: Bode tables in; CSV and UFF out."""

from rotorrig.processing.files.bode_table import read_table
from rotorrig.processing.files.response_mcap import read_response, write_response
from rotorrig.processing.files.response_scene import FRAME
from rotorrig.processing.files.response_topics import order_name

__all__ = [
    "FRAME",
    "order_name",
    "read_response",
    "read_table",
    "write_response",
]
