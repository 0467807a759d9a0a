"""PA14: load on the shaft of a pile in axisymmetry; elastic soil and a Coulomb interface.

Only vertical displacement is free, and nothing holds the ends of the soil cylinder, so that each
slice is sheared by itself.  The soil is weightless: its lateral stress K_0 gamma z is the traction
on the interface at the start, and stays, because nothing moves sideways.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np

from install_mpm.constitutive.parameters import CoulombInterface, HenckyElastic
from install_mpm.conventions import Kinematics, Unit
from install_mpm.equilibrium import Prescribed
from install_mpm.ground import Ground
from install_mpm.interface import InterfaceElements, InterfacePoints, reaction
from install_mpm.pile import PileMotion
from workflows.verification.body import Body, advance, make_body
from workflows.verification.problem import Outcome, Problem, Series, relative
from workflows.verification.rectangle import rectangle_mesh
from workflows.verification.references.shaft import shaft_load
from workflows.verification.rigid_facets import facet_elements, facet_points, rigid_interface

ROUND_OFF = 1e-11
"""Relative residual that is round-off of the stiff soil and interface."""

STICKING = 1e-7
"""First settlement over that of full slip: the shaft still sticks but for its uppermost part."""


def shaft_friction(
    *,
    a: Annotated[float, Unit("m")] = 0.5,
    b: Annotated[float, Unit("m")] = 10.0,
    L: Annotated[float, Unit("m")] = 10.0,
    G: Annotated[float, Unit("Pa")] = 5e6,
    nu: float = 0.0,
    ks: Annotated[float, Unit("Pa/m")] = 1e8,
    c: Annotated[float, Unit("Pa")] = 0.0,
    delta: Annotated[float, Unit("rad")] = float(np.deg2rad(24.0)),
    K0: float = 0.5,
    gamma: Annotated[float, Unit("N/m^3")] = 10e3,
    slices: int = 16,
    rings: int = 16,
    steps: int = 12,
) -> Outcome:
    """Return load and stiffness of the shaft, in ``steps`` to 1.2 times the settlement of slip."""
    law = CoulombInterface(ks, ks, cohesion=c, friction_angle=delta)
    body, is_prescribed = _soil_around_shaft(a, b, L, G, nu, law, K0 * gamma, slices, rings)
    full_slip = (c + K0 * gamma * L * np.tan(delta)) * (1.0 / ks + a / G * np.log(b / a))
    settlement = full_slip * np.append(STICKING, np.linspace(0.0, 1.2, steps + 1)[1:])
    loads, histories = [], []
    for down in np.diff(settlement, prepend=0.0):
        motion = PileMotion(np.array([0.0, -down]))
        held = Prescribed(is_prescribed, np.zeros_like(body.mesh.nodes))
        body, result = advance(body, held, motion=motion, name=f"shaft, {down:.1e} m further")
        loads.append(float(reaction(body.interface)[1]))
        histories.append(tuple(result.equilibrium.newton.residuals))
    exact = shaft_load(
        settlement, radius=a, length=L, outer_radius=b, shear_modulus=G, shear_stiffness=ks,
        cohesion=c, friction_angle=delta, k0=K0, unit_weight=gamma,
    )  # fmt: skip
    checks = (
        relative("capacity of the shaft in kN", loads[-1] / 1e3, float(exact.capacity) / 1e3, 0.01),
        relative(
            "stiffness before slip in MN/m", loads[0] / settlement[0] / 1e6,
            exact.stiffness / 1e6, 0.01,
        ),
    )  # fmt: skip
    curve = Series(
        "Load on the shaft", "settlement (mm)", "load (kN)", tuple(1e3 * settlement),
        tuple(np.array(loads) / 1e3), tuple(exact.load / 1e3),
    )  # fmt: skip
    remark = "Between first and full slip the reference leaves out what slices carry to each other."
    return Outcome(checks, (curve,), (remark,), tuple(histories), ROUND_OFF)


def _soil_around_shaft(
    a: float, b: float, length: float, shear_modulus: float, nu: float, law: CoulombInterface,
    gradient: float, slices: int, rings: int,
) -> tuple[Body, np.ndarray]:  # fmt: skip
    """Return the soil from the shaft to the radius ``b``, and which dofs are held.

    ``gradient`` is that of the lateral stress with depth in Pa/m.
    """
    mesh = rectangle_mesh(np.geomspace(a, b, rings + 1), np.linspace(-length, 0.0, slices + 1))
    radius = mesh.nodes[:, 0]
    elements = facet_elements(mesh, radius < a * (1.0 + 1e-9))
    soil = HenckyElastic(2.0 * (1.0 + nu) * shear_modulus, nu)
    body = make_body(
        mesh,
        Ground(0.0, 1.0, soil),
        kinematics=Kinematics.AXISYMMETRIC,
        interface=(elements, _shaft_points(elements, facet_points(elements, mesh), length, law,
                                           gradient, slices)),
    )  # fmt: skip
    is_held = np.zeros(mesh.nodes.shape, dtype=bool)
    is_held[:, 0] = True
    is_held[radius > b * (1.0 - 1e-9), 1] = True
    return body, is_held


def _shaft_points(
    elements: InterfaceElements, position: np.ndarray, length: float, law: CoulombInterface,
    gradient: float, slices: int,
) -> InterfacePoints:  # fmt: skip
    """Return the interface points: areas of the whole circumference, the soil stress on them."""
    radius, depth = position[:, 0], -position[:, 1]
    area = 2.0 * np.pi * radius * np.tile(elements.weights, len(elements.nodes)) * length / slices
    normal = np.tile([-1.0, 0.0], (len(position), 1))
    return rigid_interface(position, normal, area, law, normal_traction=-gradient * depth)


PROBLEM = Problem("PA14", "Friction on the shaft of a pile", shaft_friction, is_quick=True)
