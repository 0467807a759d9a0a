"""Parameters of the soil and interface laws: unit, range and meaning of each, written once.

The case reader derives its checks from the annotations; ``dispatch.pack`` turns a record into the
float row that the kernels read.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

from annotated_types import Ge, Gt, Lt

from install_mpm.conventions import Unit

Stiffness = Annotated[float, Unit("Pa"), Gt(0)]
PoissonsRatio = Annotated[float, Ge(0), Lt(0.5)]
PoreFluid = Annotated[float, Unit("Pa"), Ge(0)]
"""Bulk modulus of the pore fluid over the porosity; zero if the soil drains freely."""
FrictionAngle = Annotated[float, Unit("rad"), Gt(0), Lt(1.5)]
DilationAngle = Annotated[float, Unit("rad"), Ge(0), Lt(1.5)]
VoidRatio = Annotated[float, Gt(0)]


@dataclass(frozen=True)
class HenckyElastic:
    """Isotropic elasticity, linear between Kirchhoff stress and logarithmic strain."""

    youngs_modulus: Stiffness
    poissons_ratio: PoissonsRatio
    pore_fluid_bulk_modulus: PoreFluid = 0.0
    model: Literal["hencky_elastic"] = "hencky_elastic"


@dataclass(frozen=True)
class NeoHookean:
    """Isotropic compressible neo-Hookean solid with these moduli at small strain."""

    youngs_modulus: Stiffness
    poissons_ratio: PoissonsRatio
    model: Literal["neo_hookean"] = "neo_hookean"


@dataclass(frozen=True)
class VonMises:
    """Undrained clay: Hencky elastic, perfectly plastic at ``undrained_shear_strength``.

    The strength at the original depth d of the material is ``undrained_shear_strength + gradient *
    d``; it travels with the material as a state variable.  Shearing takes it down to its value
    over ``sensitivity``, 95 % of the way at the plastic shear strain ``remoulding_strain``.
    """

    youngs_modulus: Stiffness
    poissons_ratio: PoissonsRatio
    undrained_shear_strength: Annotated[float, Unit("Pa"), Gt(0)]
    undrained_shear_strength_gradient: Annotated[float, Unit("Pa/m"), Ge(0)] = 0.0
    sensitivity: Annotated[float, Ge(1)] = 1.0
    remoulding_strain: Annotated[float, Gt(0)] = 20.0
    model: Literal["von_mises"] = "von_mises"


@dataclass(frozen=True)
class Tresca:
    """Undrained clay: Hencky elastic, perfectly plastic at the largest shear stress s_u.

    In plane strain the same as ``VonMises`` but for the stress out of the plane; in other modes,
    such as triaxial ones, von Mises is the weaker by up to 13 %.
    """

    youngs_modulus: Stiffness
    poissons_ratio: PoissonsRatio
    undrained_shear_strength: Annotated[float, Unit("Pa"), Gt(0)]
    undrained_shear_strength_gradient: Annotated[float, Unit("Pa/m"), Ge(0)] = 0.0
    sensitivity: Annotated[float, Ge(1)] = 1.0
    remoulding_strain: Annotated[float, Gt(0)] = 20.0
    model: Literal["tresca"] = "tresca"


@dataclass(frozen=True)
class MohrCoulomb:
    """Sand, or any drained soil: Hencky elastic, perfectly plastic at Mohr-Coulomb's criterion.

    The dilation angle psi must not exceed the friction angle phi (equal: associated flow, which
    limit theorems assume and soil does not follow).  With ``critical_void_ratio``, sin(psi) falls
    linearly from its value at ``initial_void_ratio`` to zero there, and what has opened at the apex
    closes before it carries pressure; without, dilation never ends.

    Typical values (Bolton 1986; Lambe and Whitman 1969, tables 3.2 and 11.3): phi 30 to 34 deg in
    loose and 36 to 45 deg in dense quartz sand, psi about phi - 30 deg, at least 0; c 0 to 1 kPa; E
    10 to 30 MPa loose, 40 to 80 MPa dense; nu 0.2 to 0.3; e 0.5 dense to 0.9 loose, and at the
    critical state 0.7 to 0.85 under moderate pressure.
    """

    youngs_modulus: Stiffness
    poissons_ratio: PoissonsRatio
    cohesion: Annotated[float, Unit("Pa"), Ge(0)]
    friction_angle: FrictionAngle
    dilation_angle: DilationAngle = 0.0
    initial_void_ratio: VoidRatio = 0.7
    critical_void_ratio: Annotated[float | None, Gt(0)] = None
    pore_fluid_bulk_modulus: PoreFluid = 0.0
    model: Literal["mohr_coulomb"] = "mohr_coulomb"

    def __post_init__(self) -> None:
        _check_flow(self)


@dataclass(frozen=True)
class DruckerPrager:
    """The same as ``MohrCoulomb`` with a cone in place of the pyramid: smooth but for its apex.

    ``cone`` says where the two agree: in triaxial ``compression`` (the cone around the pyramid), in
    triaxial ``extension``, in collapse under ``plane_strain``, where they agree for the two angles
    as they stand, or nowhere outside it (``inner``, the largest cone inside the pyramid).  The
    compression cone is much too strong in other modes: in extension by a factor of two at 30 deg.
    """

    youngs_modulus: Stiffness
    poissons_ratio: PoissonsRatio
    cohesion: Annotated[float, Unit("Pa"), Ge(0)]
    friction_angle: FrictionAngle
    dilation_angle: DilationAngle = 0.0
    cone: Literal["compression", "extension", "plane_strain", "inner"] = "compression"
    initial_void_ratio: VoidRatio = 0.7
    critical_void_ratio: Annotated[float | None, Gt(0)] = None
    pore_fluid_bulk_modulus: PoreFluid = 0.0
    model: Literal["drucker_prager"] = "drucker_prager"

    def __post_init__(self) -> None:
        _check_flow(self)


def _check_flow(soil: MohrCoulomb | DruckerPrager) -> None:
    if soil.dilation_angle > soil.friction_angle:
        raise ValueError(
            f"dilation_angle {soil.dilation_angle:.4g} rad is larger than friction_angle "
            f"{soil.friction_angle:.4g} rad, which would make energy; lower it"
        )


FrictionalSoil = MohrCoulomb | DruckerPrager
"""Soil laws with friction, dilation and a void ratio as state."""


@dataclass(frozen=True)
class ModifiedCamClay:
    """Clay of critical-state theory: strength and stiffness follow pressure and void ratio.

    Stress is effective; ``pore_fluid_bulk_modulus`` makes the clay undrained.  The shear modulus
    is constant if ``shear_modulus`` is given, otherwise it follows the bulk modulus through
    ``poissons_ratio``.  The preconsolidation pressure of the ground is that of the ellipse through
    the initial stress times ``overconsolidation_ratio`` plus ``pre_overburden_pressure``; it is
    never below ``lowest_pressure``, under which the bulk modulus does not fall any more.
    """

    critical_stress_ratio: Annotated[float, Gt(0)]
    compression_index: Annotated[float, Gt(0)]
    swelling_index: Annotated[float, Gt(0)]
    void_ratio: Annotated[float, Gt(0)]
    poissons_ratio: PoissonsRatio = 0.3
    shear_modulus: Annotated[float, Unit("Pa"), Ge(0)] = 0.0
    overconsolidation_ratio: Annotated[float, Ge(1)] = 1.0
    pre_overburden_pressure: Annotated[float, Unit("Pa"), Ge(0)] = 0.0
    lowest_pressure: Annotated[float, Unit("Pa"), Gt(0)] = 1e3
    pore_fluid_bulk_modulus: PoreFluid = 0.0
    model: Literal["modified_cam_clay"] = "modified_cam_clay"

    def __post_init__(self) -> None:
        """Refuse a normal compression line that is not steeper than the swelling lines."""
        if self.swelling_index >= self.compression_index > 0.0:
            raise ValueError(
                f"swelling_index {self.swelling_index:g} is not below compression_index"
                f" {self.compression_index:g}; clay swells less than it was compressed"
            )


@dataclass(frozen=True)
class CriticalStateSand:
    """Sand whose friction and dilation follow from its void ratio and pressure.

    Stress is effective; ``pore_fluid_bulk_modulus`` makes the sand undrained.  The critical void
    ratio is ``critical_void_ratio`` at a mean pressure of 1 kPa and falls by
    ``critical_state_slope`` for every factor e of pressure.  The shear modulus at the pressure p is
    ``reference_shear_modulus * (p / reference_pressure)^stiffness_exponent``; under
    ``lowest_pressure`` stiffness and critical void ratio do not change any more.
    """

    void_ratio: Annotated[float, Gt(0)]
    critical_stress_ratio: Annotated[float, Gt(0)]
    critical_void_ratio: Annotated[float, Gt(0)]
    critical_state_slope: Annotated[float, Ge(0)]
    reference_shear_modulus: Stiffness
    state_dilatancy: Annotated[float, Ge(0)] = 3.5
    volumetric_coupling: Annotated[float, Ge(0), Lt(1)] = 0.3
    stiffness_exponent: Annotated[float, Ge(0), Lt(1)] = 0.5
    poissons_ratio: PoissonsRatio = 0.2
    reference_pressure: Annotated[float, Unit("Pa"), Gt(0)] = 100e3
    lowest_pressure: Annotated[float, Unit("Pa"), Gt(0)] = 1e3
    pore_fluid_bulk_modulus: PoreFluid = 0.0
    model: Literal["critical_state_sand"] = "critical_state_sand"


UndrainedClay = VonMises | Tresca
"""Soil laws whose strength is ``undrained_shear_strength``, a state variable."""

HookeanSoil = HenckyElastic | NeoHookean | VonMises | Tresca | MohrCoulomb | DruckerPrager
"""Soil laws with a Young's modulus that does not depend on the pressure."""

SoilParameters = HookeanSoil | ModifiedCamClay | CriticalStateSand
"""Every soil law a case can name; ``model`` tells them apart."""


@dataclass(frozen=True)
class CoulombInterface:
    """Pile-soil interface: elastic springs limited by Mohr-Coulomb friction (paper, eqs 10-14).

    The cohesion is ``cohesion + adhesion_factor * undrained_shear_strength`` of the adjacent
    ground; undrained clay has ``adhesion_factor`` alpha and no friction.  Without friction the
    interface also carries tension (it is bonded in the normal direction), unless
    ``tensile_strength`` limits it; with friction the tension ends at the apex c / tan(phi).
    """

    normal_stiffness: Annotated[float, Unit("Pa/m"), Gt(0)]
    shear_stiffness: Annotated[float, Unit("Pa/m"), Gt(0)]
    cohesion: Annotated[float, Unit("Pa"), Ge(0)] = 0.0
    adhesion_factor: Annotated[float, Ge(0)] = 0.0
    friction_angle: Annotated[float, Unit("rad"), Ge(0), Lt(1.5)] = 0.0
    dilation_angle: Annotated[float, Unit("rad"), Ge(0), Lt(1.5)] = 0.0
    smoothing_stress: Annotated[float, Unit("Pa"), Ge(0)] = 0.0
    """Contact pressure below which opening is smooth; zero for the exact return to the apex.

    It has to be positive where ``tensile_strength`` limits the tension.
    """
    tensile_strength: Annotated[float | None, Unit("Pa"), Ge(0)] = None
    """Largest tension; zero for an interface that opens without any.

    As it opens, what it cuts off from the strength falls to zero over the ``smoothing_stress``.
    """
