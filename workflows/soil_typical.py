"""Typical parameters of the soil laws, with range and source: for a first try, not for design."""

from __future__ import annotations

from typing import Any, NamedTuple


class Typical(NamedTuple):
    """A value to start from, and what is usual."""

    value: Any
    note: str
    """Typical range and its source."""


LAMBE = "Lambe and Whitman 1969"
BOLTON = "Bolton 1986"
WOOD = "Wood 1990"
JEFFERIES = "Jefferies and Been 2016"

FLUID = "0 drained; undrained some 50 times the stiffness of the skeleton, water has 4 GPa"
DRAINED = {"pore_fluid_bulk_modulus": Typical("0 Pa", FLUID)}
LOWEST_PRESSURE = {
    "lowest_pressure": Typical("1 kPa", "1 kPa: below it the stiffness falls no more")
}
MODULI = {
    "youngs_modulus": Typical("20 MPa", f"5 MPa soft clay to 80 MPa dense sand ({LAMBE})"),
    "poissons_ratio": Typical(0.3, f"0.2 to 0.35 drained ({LAMBE}), 0.49 undrained"),
}
TOTAL_STRESS_CLAY = {
    "youngs_modulus": Typical(
        "8 MPa", "E_u 100 to 500 s_u, the more the less plastic (Duncan and Buchignani 1976)"
    ),
    "poissons_ratio": Typical(0.49, "0.49: undrained soil keeps its volume"),
    "undrained_shear_strength": Typical(
        "20 kPa", "12 to 25 kPa soft, 25 to 50 firm, 50 to 100 stiff (BS 5930)"
    ),
    "undrained_shear_strength_gradient": Typical(
        "1.5 kPa/m", "0.2 to 0.3 of the effective unit weight in soft clay (Mesri 1975: 0.22)"
    ),
    "sensitivity": Typical(3.0, "2 to 4 in most clays, above 8 sensitive (Skempton 1952)"),
    "remoulding_strain": Typical(20.0, "10 to 50 (Einav and Randolph 2005)"),
}
FRICTIONAL = {
    "youngs_modulus": Typical("40 MPa", f"10 to 30 MPa loose, 40 to 80 MPa dense ({LAMBE})"),
    "poissons_ratio": Typical(0.25, f"0.2 to 0.3 ({LAMBE})"),
    "cohesion": Typical("1 kPa", "0 to 1 kPa in clean sand; a little helps at the surface"),
    "friction_angle": Typical("36 deg", f"30 to 34 deg loose, 36 to 45 deg dense ({BOLTON})"),
    "dilation_angle": Typical("6 deg", f"about the friction angle less 30 deg ({BOLTON})"),
    "initial_void_ratio": Typical(0.6, f"0.5 dense to 0.9 loose ({LAMBE})"),
    "critical_void_ratio": Typical(
        0.75, "0.7 to 0.85 under moderate pressure (Been and Jefferies 1985)"
    ),
    **DRAINED,
}
CAM_CLAY = {
    "critical_stress_ratio": Typical(1.0, f"0.8 to 1.2, for 21 to 30 deg of friction ({WOOD})"),
    "compression_index": Typical(0.2, f"lambda: 0.1 to 0.3, soft clay 0.2 ({WOOD})"),
    "swelling_index": Typical(0.04, f"kappa: a fifth of lambda, 0.02 to 0.06 ({WOOD})"),
    "void_ratio": Typical(1.2, f"0.8 to 2 in soft clay ({LAMBE})"),
    "poissons_ratio": Typical(0.3, f"0.25 to 0.35 ({WOOD})"),
    "shear_modulus": Typical("0 Pa", "0: it follows the pressure with that Poisson's ratio"),
    "overconsolidation_ratio": Typical(1.3, "1 to 1.5 soft, 2 to 8 stiff clay"),
    "pre_overburden_pressure": Typical("5 kPa", "0 to 20 kPa: a dried crust is stronger"),
    **LOWEST_PRESSURE,
    "pore_fluid_bulk_modulus": Typical("100 MPa", FLUID),
}
CRITICAL_STATE_SAND = {
    "void_ratio": Typical(0.65, f"0.5 dense to 0.9 loose ({LAMBE})"),
    "critical_stress_ratio": Typical(1.25, f"1.2 to 1.35, for 30 to 33.5 deg ({JEFFERIES})"),
    "critical_void_ratio": Typical(0.85, f"0.7 to 1.0 at 1 kPa ({JEFFERIES})"),
    "critical_state_slope": Typical(0.025, f"0.01 to 0.07 per factor e ({JEFFERIES})"),
    "reference_shear_modulus": Typical("30 MPa", f"20 to 80 MPa at 100 kPa ({JEFFERIES})"),
    "state_dilatancy": Typical(3.5, f"2.5 to 4.5 ({JEFFERIES})"),
    "volumetric_coupling": Typical(0.3, f"0.2 to 0.5 ({JEFFERIES})"),
    "stiffness_exponent": Typical(0.5, "0.4 to 0.6 (Hardin and Drnevich 1972)"),
    "poissons_ratio": Typical(0.2, f"0.1 to 0.25 ({JEFFERIES})"),
    "reference_pressure": Typical("100 kPa", "that of the reference shear modulus"),
    **LOWEST_PRESSURE,
    **DRAINED,
}
CONE = {"cone": Typical("compression", "compression, as triaxial tests are")}

TYPICAL: dict[str, dict[str, Typical]] = {
    "hencky_elastic": MODULI | DRAINED,
    "neo_hookean": MODULI,
    "von_mises": TOTAL_STRESS_CLAY,
    "tresca": TOTAL_STRESS_CLAY,
    "mohr_coulomb": FRICTIONAL,
    "drucker_prager": FRICTIONAL | CONE,
    "modified_cam_clay": CAM_CLAY,
    "critical_state_sand": CRITICAL_STATE_SAND,
}
"""Typical parameters of every soil law by its name."""
