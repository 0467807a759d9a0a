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


@dataclass(frozen=True)
class HenckyElastic:
    """Isotropic elasticity, linear between Kirchhoff stress and logarithmic strain."""

    youngs_modulus: Stiffness
    poissons_ratio: PoissonsRatio
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
    d``; it travels with the material as a state variable.
    """

    youngs_modulus: Stiffness
    poissons_ratio: PoissonsRatio
    undrained_shear_strength: Annotated[float, Unit("Pa"), Gt(0)]
    undrained_shear_strength_gradient: Annotated[float, Unit("Pa/m"), Ge(0)] = 0.0
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
    model: Literal["tresca"] = "tresca"


UndrainedClay = VonMises | Tresca
"""Soil laws whose strength is ``undrained_shear_strength``, a state variable."""

SoilParameters = HenckyElastic | NeoHookean | VonMises | Tresca
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
    """Contact pressure below which opening is smooth; zero for the exact return to the apex."""
    tensile_strength: Annotated[float | None, Unit("Pa"), Ge(0)] = None
    """Largest tension; zero for an interface that opens without any.

    Where it cuts off adhesion, the strength falls to zero over the ``smoothing_stress``.
    """
