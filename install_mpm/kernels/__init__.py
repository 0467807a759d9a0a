"""Numba loops of the installation stage.

No I/O, no allocation of state, equations with their numbers.
"""
