"""The identifier's rotor model.

`model` (finite elements), `modes`, `steady` and `swept` responses, `nonlinear` forces.
"""
