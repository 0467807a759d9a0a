"""PA10 and FIG7: a rigid ellipse turns in a disc of elastic soil with a fixed rim (paper, Fig. 7).

At small rotation the torque comes from complex series.  At large rotation there is no reference:
two meshes and two laws of mesh motion have to agree for the neo-Hookean solid up to 90 degrees.  A
Hencky solid loses ellipticity long before; where it does, its picture depends on the mesh and no
torque is compared.  No size is given in the paper; 2 m x 1 m in a circle of 5 m is assumed.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Annotated, Any, NamedTuple

import numpy as np

from install_mpm.constitutive.parameters import HenckyElastic, NeoHookean, SoilParameters
from install_mpm.conventions import Unit
from install_mpm.mesh_motion import rotate_clockwise
from install_mpm.options import Numerics
from workflows.verification.body import Body
from workflows.verification.disc_meshes import circle
from workflows.verification.disc_meshes import ellipse as ellipse_corners
from workflows.verification.ellipticity import is_elliptic
from workflows.verification.problem import (
    Outcome,
    Picture,
    Problem,
    Series,
    at_least,
    at_most,
    relative,
)
from workflows.verification.references.annulus_incompressible import (
    largest_incompressible_rotation,
)
from workflows.verification.references.ellipse_rotation import ellipse_rotation
from workflows.verification.turned_disc import STEP, Disc, MeshLaw, Turned, disc_body, turn

RIM_SIDES, COARSE, FINE = 72, 48, 72
"""Sides of the rim, which maps onto itself in a step of 5 degrees, and of the ellipse."""
SMALL_ROTATION = 1e-7
"""In rad: the problem is linear, and one Newton correction solves it."""
COMPRESSIBLE = Numerics(volumetric_term=0.0)
SMALL = Numerics(volumetric_term=0.0, tolerance=1e-6)
ONE_MESH_TO_ANOTHER = 2e-2

SHOWN = (45.0, 90.0)
"""Rotations in degrees that the paper shows."""

Length = Annotated[float, Unit("m")]
Modulus = Annotated[float, Unit("Pa")]


def small_rotation(
    *, p: Length = 2.0, q: Length = 1.0, R: Length = 5.0, E: Modulus = 10e3, nu: float = 0.0
) -> Outcome:
    """Return the rotational stiffness of the ellipse (PA10)."""
    turned = turn(_disc(p, q, R, FINE), HenckyElastic(E, nu), SMALL_ROTATION, numerics=SMALL)
    exact = ellipse_rotation(
        semi_major=p, semi_minor=q, outer_radius=R, youngs_modulus=E, poissons_ratio=nu
    ).stiffness
    computed = turned.torque[0] / SMALL_ROTATION
    return Outcome(
        (relative("torque over rotation in N m/rad per metre", computed, exact, 5e-3),),
        residual_histories=turned.residuals,
    )


def large_rotation(
    *, p: Length = 2.0, q: Length = 1.0, R: Length = 5.0, E: Modulus = 10e3, nu: float = 0.0
) -> Outcome:
    """Return the neo-Hookean torque up to 90 degrees on two meshes and by two laws (FIG7)."""
    soil, angle = NeoHookean(E, nu), np.pi / 2.0
    album = _Album(_disc(p, q, R, FINE))
    coarse = turn(_disc(p, q, R, COARSE), soil, angle, numerics=COMPRESSIBLE)
    fine = turn(album.disc, soil, angle, numerics=COMPRESSIBLE, observe=album.keep)
    tapered = turn(_disc(p, q, R, FINE, MeshLaw.TAPERED), soil, angle, numerics=COMPRESSIBLE)
    checks = [at_least("rotation reached in degrees", np.rad2deg(fine.angle[-1]), 90.0 - 1e-9)]
    for degrees in (45.0, 90.0):
        k = round(np.deg2rad(degrees) / STEP) - 1
        for name, other in (("other mesh", coarse), ("tapered mesh motion", tapered)):
            text = f"torque at {degrees:g} degrees in N m per metre, against the {name}"
            checks.append(relative(text, fine.torque[k], other.torque[k], ONE_MESH_TO_ANOTHER))
    return Outcome(
        tuple(checks),
        (_curve("Neo-Hookean soil: fine mesh beside coarse mesh", fine, coarse),),
        residual_histories=coarse.residuals + fine.residuals + tapered.residuals,
        pictures=(album.picture(soil),),
    )


def hencky_rotation(
    *, p: Length = 2.0, q: Length = 1.0, R: Length = 5.0, E: Modulus = 10e3, nu: float = 0.0
) -> Outcome:
    """Return the Hencky torque as far as it goes, and where ellipticity is lost (FIG7-HENCKY).

    While the soil is elliptic everywhere the torques of two meshes have to agree.  It cannot stay
    so for longer than beside an incompressible circle: an ellipse concentrates the strain.
    """
    soil, album = HenckyElastic(E, nu), _Album(_disc(p, q, R, FINE))
    runs = {
        name: _turn_hencky(_disc(p, q, R, sides), soil, keep)
        for name, sides, keep in (("fine", FINE, album.keep), ("coarse", COARSE, _look_away))
    }
    (fine, _), (coarse, _) = runs.values()
    elliptic = min(len(looks.elliptic) for _, looks in runs.values())
    bound = largest_incompressible_rotation(inner_radius=q, outer_radius=R)
    k, reached = max(elliptic - 1, 0), np.rad2deg(elliptic * STEP)
    text = f"torque at {np.rad2deg(fine.angle[k]):g} degrees in N m per metre, against other mesh"
    return Outcome(
        (
            relative(text, fine.torque[k], coarse.torque[k], ONE_MESH_TO_ANOTHER),
            at_most("last rotation with elliptic soil in degrees", reached, np.rad2deg(bound)),
        ),
        (_curve("Hencky soil: fine mesh beside coarse mesh", fine, coarse),),
        tuple(_in_words(name, *run) for name, run in runs.items()),
        residual_histories=fine.residuals + coarse.residuals,
        pictures=(album.picture(soil),),
    )


class _Album:
    """States of a rotation that the paper shows: 45 and 90 degrees, or the last one reached."""

    def __init__(self, disc: Disc) -> None:
        self.disc = disc
        self.states: dict[float, Body] = {}

    def keep(self, angle: float, body: Body) -> None:
        """Keep the state if it is one of the paper's, or the last one so far."""
        for degrees in [d for d in self.states if d not in SHOWN]:
            del self.states[degrees]
        self.states[round(float(np.rad2deg(angle)), 6)] = body

    def picture(self, soil: SoilParameters) -> Picture:
        """Return the picture of initial and kept states."""
        return Picture("states", "Rotation of the ellipse as in Fig. 7", partial(self._draw, soil))

    def _draw(self, soil: SoilParameters) -> Any:
        from workflows.verification.paper_drawings import turned_states

        first = disc_body(self.disc, soil, COMPRESSIBLE)
        bodies = {0.0: first, **self.states}
        return turned_states(
            [
                (f"{degrees:g} degrees", (body.points, body.mesh),
                 rotate_clockwise(self.disc.hole, -np.deg2rad(degrees)))
                for degrees, body in bodies.items()
            ]
        )  # fmt: skip


def _look_away(angle: float, body: Body) -> None:
    """Keep nothing."""


class _Looks(NamedTuple):
    """What was found after each step of a rotation of Hencky soil."""

    elliptic: list[float]
    """Rotations in rad up to which all material points are elliptic."""
    lost: list[tuple[float, float, float]]
    """Rotation in rad, share of the area and mean radius in m of points that are not."""


def _turn_hencky(
    disc: Disc, soil: HenckyElastic, keep: Callable[[float, Body], None]
) -> tuple[Turned, _Looks]:
    """Return the rotation as far as it goes, and where the soil has lost ellipticity."""
    shear_modulus = soil.youngs_modulus / (2.0 * (1.0 + soil.poissons_ratio))
    first_lame = 2.0 * shear_modulus * soil.poissons_ratio / (1.0 - 2.0 * soil.poissons_ratio)
    looks = _Looks([], [])

    def look(angle: float, body: Body) -> None:
        keep(angle, body)
        points = body.points
        is_lost = ~is_elliptic(points.elastic_log_strain, shear_modulus, first_lame)
        if is_lost.any():
            radius = np.linalg.norm(points.position[is_lost], axis=1).mean()
            share = points.volume[is_lost].sum() / points.volume.sum()
            looks.lost.append((angle, share, radius))
        elif not looks.lost:
            looks.elliptic.append(angle)

    turned = turn(disc, soil, np.pi / 2.0, numerics=COMPRESSIBLE, may_stop=True, observe=look)
    return turned, looks


def _in_words(name: str, turned: Turned, looks: _Looks) -> str:
    """Return what became of the rotation on the mesh ``name``."""
    reached = f"{name} mesh: the last step that converges ends at"
    reached = f"{reached} {np.rad2deg(turned.angle[-1]):g} degrees"
    if not looks.lost:
        return f"{reached}; all soil is elliptic there"
    angle, share, radius = looks.lost[0]
    return (
        f"{reached}; at {np.rad2deg(angle):g} degrees {100.0 * share:.2g} % of the soil, at a mean"
        f" radius of {radius:.3g} m, is not elliptic"
    )


def _disc(p: float, q: float, rim: float, n_sides: int, mesh_law: MeshLaw = MeshLaw.WHOLE) -> Disc:
    return Disc(circle(rim, RIM_SIDES), ellipse_corners(p, q, n_sides), mesh_law)


def _curve(title: str, fine: Turned, coarse: Turned) -> Series:
    n = min(len(fine.angle), len(coarse.angle))
    return Series(
        title,
        "rotation in degrees",
        "torque in N m per metre",
        tuple(np.rad2deg(fine.angle[:n])),
        tuple(fine.torque[:n]),
        tuple(coarse.torque[:n]),
    )


PROBLEMS = (
    Problem("PA10", "Rigid ellipse in a disc, small rotation", small_rotation, is_quick=True),
    Problem("FIG7", "Ellipse turned by 90 degrees, neo-Hookean", large_rotation, is_quick=False),
    Problem(
        "FIG7-HENCKY", "Ellipse turned in Hencky soil: loss of ellipticity", hencky_rotation,
        is_quick=False,
    ),
)  # fmt: skip
