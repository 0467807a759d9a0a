"""Numba loops of the installation stage: no I/O, no allocation of state."""
