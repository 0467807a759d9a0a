"""Constitutive laws shared by the installation (MPM) and the service (FE) stage; imports nothing of the project."""
