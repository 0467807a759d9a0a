"""A block of Mohr-Coulomb soil settles between rollers: meshes that do not disturb its state.

A published open implementation of the material point method does not get through this problem: with
Mohr-Coulomb soil its iterations stall, and elements are inverted.  The block is as high as wide,
supported on its base and sides, and its gravity grows in equal steps.  Its cross section cannot
change, so the vertical Cauchy stress is - rho g (H - Y), Y the original height, whatever the soil;
with nu / (1 - nu) below the ratio K_a the soil yields below the depth at which cohesion ends.

Both horizontal stresses are then K_a times the vertical one: the state is on an edge.  There, with
the modulus M of one-dimensional compression and the tangent G_t of shear, soil without dilation has
the acoustic determinant

    det Q(n) = M G_t (K_a n_x^2 - n_y^2) (n_x^2 - n_y^2) ,

negative for n_y^2 between K_a n_x^2 and n_x^2: the equations are not elliptic, and any disturbance
of the one-dimensional state grows from step to step until neighbouring points leave the edge in
turn and the iterations stall; lost ellipticity has no length, and the finer the mesh the shorter
and faster the waves that grow.  So the discretisation must not disturb the one-dimensional state: a
motion that depends on the height alone has to be in equilibrium on the mesh to round-off.

In plane strain symmetry sees to that.  Squares that are cut by both diagonals into linear triangles
have all their nodes on planes of symmetry, and the mesh can stay where it is while points cross its
lines.  A body of revolution has no such planes.  There, and in space, three things do it together:

- linear cells in rows, squares cut by one diagonal and cubes cut into six tetrahedra (the meshes of
  that implementation): a vertical motion that is linear over a row strains all its cells alike, and
  a stress that is constant in a row is in equilibrium across;
- the weight is shared out by the linear functions of the mesh in plan times hat functions of the
  height, as the stress of a row is.  The functions of triangles and tetrahedra themselves load the
  corners and edges of the block differently, and in axisymmetry every node of the surface;
- the mesh follows the soil, so that the points of a row stay in it.  They would cross the lines of
  a resting mesh into one triangle of a square earlier than into the other.

With any of them missing the steps of a fine mesh do not converge: n = 50 in axisymmetry and c = 1
kPa, 10 steps, stalls in step 3 if the mesh stays or the triangles share out the weight themselves,
and in step 1 if squares are crossed.  Quadratic cells on a mesh that stays fare better, for all
that they disturb (they integrate the kink of the horizontal stress at the depth of first yield with
an error).  In axisymmetry with n = 50 they take six iterations with c = 5 kPa and ten with c = 1
kPa; in space with c = 1 kPa five, six and seven with n = 8, 12 and 16.

In space one thing is left that no mesh can mend.  On the edge both horizontal stresses stay equal
whatever the horizontal distortion, so a horizontal motion without change of area, the same at all
heights, meets no resistance.  Only the soil under the surface that cohesion keeps elastic resists,
and the cells have to see it: with c = 1 kPa it is 0.7 m thick, and n = 8 is enough.  On coarser
meshes every row yields in the end: in that step round-off decides on a sideways motion (1e-5 m to
1e-4 m), which has taken up to 15 iterations.

Nothing is held sideways but the boundary; the problems check that nothing moves sideways.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from install_mpm.background_mesh import BackgroundMesh
from install_mpm.constitutive.parameters import MohrCoulomb
from install_mpm.conventions import GRAVITY, Kinematics
from install_mpm.equilibrium import Prescribed
from install_mpm.ground import Ground
from install_mpm.options import Numerics
from workflows.verification.body import Body, advance, make_body
from workflows.verification.gravity import mesh_to, with_weight_of_points
from workflows.verification.rectangle import rectangle_mesh
from workflows.verification.solid_meshes import Plane, extruded, grid, linear_mesh

TOLERANCE = 1e-9


class Block(NamedTuple):
    """What is loaded, on which mesh and in how many steps."""

    soil: MohrCoulomb
    height: float
    """Height and width (in axisymmetry radius) in m."""
    weight: float
    """Unit weight in N/m^3 of the undeformed soil."""
    n: int
    """Squares (cubes) per side."""
    steps: int
    kinematics: Kinematics

    @property
    def is_crossed(self) -> bool:
        """Whether squares are cut by both diagonals: symmetry holds the state; else rows do."""
        return self.kinematics == Kinematics.PLANE_STRAIN


class Settled(NamedTuple):
    """The block under its whole weight."""

    body: Body
    carried: float
    """Vertical reaction of the base in N."""
    histories: tuple[tuple[float, ...], ...]
    """Relative Newton residuals of every step."""


def settle(block: Block) -> Settled:
    """Return the block after gravity has grown in equal steps.

    Raises
    ------
    ProblemNotSolvedError
        If a step does not converge; none is repeated or cut.
    """
    lines = np.linspace(0.0, block.height, block.n + 1)
    body = _unloaded(block, lines)
    places = body.mesh.nodes
    on_sides = (places[:, :-1] == 0.0) | (places[:, :-1] == block.height)
    supports = np.column_stack([on_sides, places[:, -1] == 0.0])
    weight = np.zeros_like(places)
    if not block.is_crossed:
        weight[:, -1] = weight_on_nodes(lines, block.weight, block.kinematics)
    reaction, histories = np.zeros_like(places), []
    for number in range(1, block.steps + 1):
        share = number / block.steps
        # the step knows one strength of gravity, so the points become heavier instead
        mass = body.points.volume / body.points.volume_ratio * block.weight / GRAVITY * share
        body = body._replace(points=body.points._replace(mass=mass))
        prescribed = Prescribed(supports, np.zeros_like(places), share * weight)
        body, result = advance(body, prescribed, name=f"block, step {number}")
        if not block.is_crossed:
            moved = body.mesh.nodes + result.equilibrium.displacement
            body = mesh_to(body, body.mesh._replace(nodes=moved))
        reaction = result.equilibrium.reaction
        histories.append(tuple(result.equilibrium.newton.residuals))
    return Settled(body, float(reaction[places[:, -1] == 0.0, -1].sum()), tuple(histories))


def _unloaded(block: Block, lines: np.ndarray) -> Body:
    """Return the block without weight on the mesh of the grid ``lines`` (n + 1,) in m."""
    mesh = _mesh(block, lines)
    body = make_body(
        mesh, Ground(0.0, 1.0, block.soil), kinematics=block.kinematics,
        is_soil=np.ones(len(mesh.cell_nodes), dtype=bool), numerics=Numerics(tolerance=TOLERANCE),
        per_direction=2 if block.is_crossed else 1,
    )  # fmt: skip
    if block.is_crossed:
        return with_weight_of_points(body)
    return body._replace(model=body.model._replace(gravity=0.0))  # the nodes carry the weight


def _mesh(block: Block, lines: np.ndarray) -> BackgroundMesh:
    """Return the mesh of linear simplices that does not disturb the one-dimensional state."""
    if block.kinematics == Kinematics.THREE_D:
        return linear_mesh(extruded(grid(lines, lines), lines))
    return rectangle_mesh(lines, lines, is_crossed=block.is_crossed, is_quadratic=False)


def weight_on_nodes(lines: np.ndarray, weight: float, kinematics: Kinematics) -> np.ndarray:
    """Return the load of the weight, upward, on the nodes of a mesh of rows, (n_nodes,) in N.

    The body is one of revolution or a cube.  The load is shared out by the linear functions of the
    mesh in plan times hat functions of the height.

    Parameters
    ----------
    lines
        Grid lines in m, ascending, the same in every direction.
    weight
        Unit weight in N/m^3.
    """
    if kinematics == Kinematics.THREE_D:
        plan = _areas(grid(lines, lines))
    else:
        plan = _integrals_of_hats(lines, 2.0 * np.pi * lines)
    load: np.ndarray = -weight * np.outer(_integrals_of_hats(lines, np.ones_like(lines)), plan)
    return load.ravel()


def _areas(plane: Plane) -> np.ndarray:
    """Return the integral of the linear function of each vertex of a plane mesh, in m^2."""
    corners = plane.vertices[plane.triangles]
    areas = np.abs(np.linalg.det(corners[:, 1:] - corners[:, :1])) / 2.0
    return np.bincount(plane.triangles.ravel(), np.repeat(areas / 3.0, 3))


def _integrals_of_hats(lines: np.ndarray, factor: np.ndarray) -> np.ndarray:
    """Return the integral of each hat function times a factor, linear between ``lines`` (n,)."""
    sixth = np.diff(lines) / 6.0
    integrals = np.zeros_like(lines)
    integrals[:-1] += sixth * (2.0 * factor[:-1] + factor[1:])
    integrals[1:] += sixth * (factor[:-1] + 2.0 * factor[1:])
    return integrals
