"""External reference solutions: pure functions of the physical parameters, numpy and scipy only.

SI units, tension positive.  They share no code with the numerics that they judge.
"""
