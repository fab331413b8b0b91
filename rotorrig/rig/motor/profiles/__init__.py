"""Modbus drives, one file each: registers, scaling, status bits, watchdog, as the drive's manual gives them."""
