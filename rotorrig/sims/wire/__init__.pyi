from .console import Message as Message
from .fault_script import read_script as read_script
from .launch import BenchPorts as BenchPorts
from .launch import simulated_bench as simulated_bench

__all__ = [
    "BenchPorts",
    "Message",
    "read_script",
    "simulated_bench",
]
