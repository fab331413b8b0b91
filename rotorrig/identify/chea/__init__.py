"""CHEA, the clustering-based hybrid evolutionary algorithm: a global optimiser that lists every significant minimum.

`chea()` runs a profile (`chapter`: as published; `modern`: ours), `residuals` searches with a residual vector. Knows
nothing of rotors; imports numpy and scipy alone.
"""
