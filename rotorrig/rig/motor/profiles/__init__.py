"""Modbus drives, one file each: registers, scaling, status bits, watchdog, as the drive's manual gives them.

A file holds `PROFILE`; dropping it in is all it takes: the config knows the drive by the file's name, with dashes.
"""
