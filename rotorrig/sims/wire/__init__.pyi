from .console import Said as Said
from .fault_script import read_script as read_script
from .launch import BenchPorts as BenchPorts
from .launch import simulated_bench as simulated_bench

__all__ = [
    "BenchPorts",
    "Said",
    "read_script",
    "simulated_bench",
]
