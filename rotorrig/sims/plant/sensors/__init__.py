"""Sensors of the simulated rig: probes, their cables and drivers, the keyphasor, the converter."""

from rotorrig.sims.plant.sensors.chain import MAINS, Chain, make_chain, phasors_at
from rotorrig.sims.plant.sensors.channels import FULL_SCALE_COUNTS, VOLTS_PER_COUNT, Sensors
from rotorrig.sims.plant.sensors.mounting import Mounting

__all__ = ["FULL_SCALE_COUNTS", "MAINS", "VOLTS_PER_COUNT", "Chain", "Mounting", "Sensors", "make_chain", "phasors_at"]
