"""Our profile of CHEA.

Quasi-random start, funnels, trust-region descents on local models, recombination, natural stop.
"""
