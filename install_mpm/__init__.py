"""Stage 1: quasi-static implicit material point method for the installation of a pile.

Kept empty on purpose: importing any module of this package runs this file, so a re-export here
would undo the independence of `install_mpm.constitutive` and slow every start.
"""
