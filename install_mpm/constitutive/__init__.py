"""Constitutive laws shared by the installation (MPM) and the service (FE) stage.

Imports nothing of the project.
"""
