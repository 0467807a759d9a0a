"""Constitutive laws shared by installation (MPM) and service (FE); a leaf of the project."""
