"""Names of the state variables of all soil laws, with unit and meaning, written once.

A law lists its names in the order of its columns; files, reports and pages look them up here.
"""

from __future__ import annotations

from typing import NamedTuple


class StateVariable(NamedTuple):
    """Unit and meaning of one column of ``state_variables``."""

    unit: str
    doc: str


STATE_VARIABLES = {
    "undrained_shear_strength": StateVariable("Pa", "undisturbed strength carried by the material"),
    "plastic_shear_strain": StateVariable("", "accumulated plastic shear strain sqrt(2) |d eps_p|"),
    "plastic_log_volume": StateVariable("", "ln(1 + void ratio) less the elastic volume strain"),
    "opening": StateVariable("", "part of it that closes before the soil carries pressure again"),
    "preconsolidation_pressure": StateVariable(
        "Pa", "mean effective pressure at the tip of the yield surface"
    ),
    "shear_modulus": StateVariable("Pa", "elastic shear modulus at the current pressure"),
    "excess_pore_pressure": StateVariable("Pa", "pore pressure beyond the hydrostatic one"),
    "skeleton_volume": StateVariable(
        "", "total volumetric strain of undrained soil less the elastic one of its skeleton"
    ),
}
"""Every state variable by name."""
