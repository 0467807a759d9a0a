"""PD3: vertical stiffness of the head of an elastic pile that is meshed inside, axisymmetric.

The ground is a cylinder of stated size, fixed at its side and bottom.  Pile and ground share their
nodes, and the head moves as a rigid section.  The reference is a computation in the same cylinder
with elements of another kind; the formula of Randolph and Wroth holds for ground without end.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from handoff.fe_mesh import FEMesh
from handoff.gmsh_triangles import fill_polygons
from install_mpm.constitutive.parameters import CoulombInterface, HenckyElastic
from install_mpm.conventions import Kinematics, Unit
from install_mpm.ground import LayeredGround
from service_fe.problem import ServiceProblem
from service_fe.rigid_pile import held
from workflows.errors import CaseError
from workflows.verification.elastic_pile import ground_and_pile, with_pile
from workflows.verification.problem import Outcome, Problem, Series, relative
from workflows.verification.references.pile_stiffness import head_stiffness, randolph_wroth
from workflows.verification.revolution import outer_tags, quadratic

SIZES = (2.0, 1.0, 0.5)
"""Edge length of the cells at the pile over its radius: a study of convergence."""

GROWTH = 0.2
"""Growth of the edge length per distance."""

TOLERANCE, FORMULA_TOLERANCE = 0.005, 0.05


class Site(NamedTuple):
    """Pile and ground; lengths in m, moduli in Pa."""

    length: float
    radius: float
    pile_modulus: float
    shear_modulus: float
    poissons_ratio: float
    extent: float
    """Radius of the ground."""
    depth: float
    """Of the ground."""

    @property
    def soils(self) -> LayeredGround:
        """The soil and, as the second row of the table, the pile."""
        nu = self.poissons_ratio
        soil = HenckyElastic(2.0 * (1.0 + nu) * self.shear_modulus, nu)
        return ground_and_pile(soil, HenckyElastic(self.pile_modulus, nu), self.depth)


def pd3(
    *,
    L: Annotated[float, Unit("m")] = 20.0,
    r0: Annotated[float, Unit("m")] = 0.5,
    Ep: Annotated[float, Unit("Pa")] = 30e9,
    G: Annotated[float, Unit("Pa")] = 10e6,
    nu: float = 0.3,
    extent: Annotated[float, Unit("m")] = 100.5,
    depth: Annotated[float, Unit("m")] = 120.0,
) -> Outcome:
    """The head of an elastic pile of length L and radius r0 is pushed down: force per settlement.

    The pile has Young's modulus Ep, the ground shear modulus G, both nu; the ground is a cylinder
    of radius ``extent`` and ``depth``, fixed at side and bottom.
    """
    if depth <= L or r0 >= extent:
        raise CaseError("PD3: the pile is larger than the ground; take a larger extent or depth")
    site = Site(L, r0, Ep, G, nu, extent, depth)
    study = [stiffness(site, size * r0) for size in SIZES]
    same_box = head_stiffness(**site._asdict())
    formula = randolph_wroth(
        length=L, radius=r0, pile_modulus=Ep, shear_modulus=G, poissons_ratio=nu
    )
    computed = study[-1][0]
    return Outcome(
        (
            relative("stiffness of the head in the same box (N/m)", computed, same_box, TOLERANCE),
            relative("stiffness of the head, Randolph and Wroth (N/m)", computed, formula,
                     FORMULA_TOLERANCE),
        ),
        (Series("error of the stiffness", "size at the pile / r0", "relative error", SIZES,
                tuple(abs(value / same_box - 1.0) for value, _ in study), is_logarithmic=True),),
        residual_histories=tuple(residuals for _, residuals in study),
    )  # fmt: skip


def stiffness(site: Site, size: float) -> tuple[float, tuple[float, ...]]:
    """Return the stiffness in N/m with cells of ``size`` m at the pile, and the residuals."""
    mesh = _mesh(site, size)
    r, z = mesh.nodes.T
    slack = 1e-9 * site.radius
    is_head = (r < site.radius + slack) & (np.abs(z) < slack)
    is_fixed = np.zeros(mesh.nodes.shape, dtype=bool)
    is_fixed[r < slack, 0] = True
    is_fixed[(r > site.extent - slack) | (z < slack - site.depth)] = True
    is_fixed[is_head, 1] = True
    problem = ServiceProblem(
        mesh, site.soils, CoulombInterface(1.0, 1.0), is_fixed=is_fixed,
        kinematics=Kinematics.AXISYMMETRIC,
    )  # fmt: skip
    place = problem.integration_positions
    is_pile = (place[:, 0] < site.radius) & (place[:, 1] > -site.length)
    settlement = 1e-3 * site.radius
    motion = np.zeros_like(mesh.nodes)
    motion[is_head, 1] = -settlement
    step = problem.solve(with_pile(problem, is_pile), held(), support_motion=motion)
    return float(-step.support_reaction[is_head, 1].sum() / settlement), step.residuals


def _mesh(site: Site, size: float) -> FEMesh:
    r0, length, extent, depth = site.radius, site.length, site.extent, site.depth
    toe, edge = (r0, -length), (r0, 0.0)
    pile = np.array([(0.0, -length), toe, edge, (0.0, 0.0)])
    ground = np.array(
        [(0.0, -depth), (extent, -depth), (extent, 0.0), edge, toe, (0.0, -length)]
    )  # fmt: skip

    def size_at(r: float, z: float) -> float:
        outside = np.hypot(max(r - r0, 0.0), max(-z - length, 0.0))
        return size + GROWTH * float(outside)

    nodes, cell_nodes, facet_nodes = quadratic(*fill_polygons([pile, ground], size_at))
    tags = outer_tags(nodes[facet_nodes[:, 2]], extent, depth)
    return FEMesh(nodes, cell_nodes, facet_nodes, tags)


PROBLEM = Problem("PD3", "Head of an elastic pile, vertical", pd3, is_quick=False)
