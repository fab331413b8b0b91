"""Physics and pretend hardware.

`rotor` and `effects` are the identifier's models, `plant` and `wire` the simulated rig.
"""
