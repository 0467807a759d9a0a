"""PC1: torque and force on a thin helix that follows its own pitch, from the interface alone (3D).

Two layers of soil lie on both faces of a helicoid.  All of their nodes are held, and the helix
turns and goes down between them: what acts on it are the tractions of its two faces.
"""

from __future__ import annotations

from functools import partial
from typing import Annotated, NamedTuple

import numpy as np

from install_mpm.background_mesh import BackgroundMesh
from install_mpm.constitutive.parameters import CoulombInterface, HenckyElastic
from install_mpm.conventions import Unit
from install_mpm.equilibrium import Prescribed
from install_mpm.ground import Ground
from install_mpm.pile import PileMotion
from workflows.verification.body import Body, advance, make_body
from workflows.verification.problem import Check, Outcome, Problem, at_most, relative
from workflows.verification.references.screw_pile import helix_resistance
from workflows.verification.solid_meshes import Solid, extruded, grid, quadratic_mesh
from workflows.verification.solid_surfaces import rigid_surface, surface_elements

STEPS, STEP = 3, np.deg2rad(2.5)
RINGS, SECTORS = 3, 36
SOIL = HenckyElastic(10e6, 0.3)
"""Of no account: it does not move."""
STICKING_SHARE = 1e-3
"""Slip at which the interface yields, over the travel of the rim in a step."""
NORMAL_OVER_SHEAR = 0.01
"""Stiffness of the interface.  Over a step of finite angle the chords of the helices close the gap
by p angle^3 / (48 pi), which held soil cannot give way to: the pressure must not show in the force.
"""

Length = Annotated[float, Unit("m")]


class Helicoid(NamedTuple):
    """A right-handed helicoid of one turn."""

    outer_radius: float
    inner_radius: float
    pitch: float

    def level(self, radius_angle: np.ndarray) -> np.ndarray:
        """Return the height (n,) in m at (radius, angle) (n, 2)."""
        height: np.ndarray = self.pitch * radius_angle[:, 1] / (2.0 * np.pi)
        return height

    def normals(self, position: np.ndarray, side: float) -> np.ndarray:
        """Return the exact normals (n, 3) on the upper (``side`` 1) or lower face (-1)."""
        x, y = position[:, 0], position[:, 1]
        climb = self.pitch / (2.0 * np.pi) / (x**2 + y**2)
        upward = np.column_stack([climb * y, -climb * x, np.ones(len(x))])
        normals: np.ndarray = -side * upward / np.linalg.norm(upward, axis=1)[:, None]
        return normals


def thin_helix(
    *,
    D: Length = 0.4,
    d: Length = 0.1,
    p: Length = 0.1,
    su: Annotated[float, Unit("Pa")] = 50e3,
    alpha: float = 1.0,
) -> Outcome:
    """Return torque and force at the pitch p, half of it and twice of it."""
    checks, torques = [], []
    for pitch in (p, 0.5 * p, 2.0 * p):
        helicoid = Helicoid(0.5 * D, 0.5 * d, pitch)
        torque, force = _resistance(helicoid, alpha * su)
        torques.append(torque)
        checks += closed_form_checks((D, d, pitch), alpha * su, torque, force)
    spread = max(torques) / min(torques) - 1.0
    checks.append(
        at_most("largest over smallest torque of the three pitches, less 1", spread, 0.01)
    )
    return Outcome(tuple(checks))


def closed_form_checks(
    size: tuple[float, float, float], strength: float, torque: float, force: float
) -> list[Check]:
    """Return the checks of torque in N m and upward force in N against PC1.

    ``size`` is diameter, shaft diameter and pitch in m; ``strength`` the shear strength in Pa.
    """
    diameter, shaft, pitch = size
    exact = helix_resistance(
        helix_diameter=diameter, shaft_diameter=shaft, pitch=pitch, shear_strength=strength
    )
    return [
        relative(f"torque at the pitch {pitch:g} m in N m", torque, exact.torque, 0.03),
        relative(f"upward force at the pitch {pitch:g} m in N", force, exact.force, 0.03),
    ]


def _resistance(helicoid: Helicoid, strength: float) -> tuple[float, float]:
    """Return torque in N m and upward force in N of the soil on both faces."""
    torque = force = 0.0
    for side in (1.0, -1.0):
        body = _layer(helicoid, side, strength)
        held = Prescribed(
            np.ones(body.mesh.nodes.shape, dtype=bool), np.zeros_like(body.mesh.nodes)
        )
        down = PileMotion(np.array([0.0, 0.0, -helicoid.pitch * STEP / (2.0 * np.pi)]), -STEP)
        for number in range(STEPS):
            body, result = advance(body, held, motion=down, name=f"helix, step {number + 1}")
        contact = result.equilibrium.contact
        torque += float(np.cross(contact.position, contact.force)[:, 2].sum())
        force += float(contact.force[:, 2].sum())
    return torque, force


def _layer(helicoid: Helicoid, side: float, strength: float) -> Body:
    """Return the soil on one face."""
    mesh, is_on = _layer_mesh(helicoid, side)
    elements = surface_elements(mesh, is_on)
    stiffness = strength / (STICKING_SHARE * STEP * helicoid.outer_radius)
    law = CoulombInterface(NORMAL_OVER_SHEAR * stiffness, stiffness, cohesion=strength)
    normals = partial(helicoid.normals, side=side)
    return make_body(
        mesh,
        Ground(0.0, 1.0, SOIL),
        is_soil=np.ones(len(mesh.cell_nodes), dtype=bool),
        interface=(elements, rigid_surface(mesh, elements, normals, law)),
    )


def _layer_mesh(helicoid: Helicoid, side: float) -> tuple[BackgroundMesh, np.ndarray]:
    """Return the mesh of the soil on one face, and its nodes (n_nodes,) on the helicoid."""
    radii = np.linspace(helicoid.inner_radius, helicoid.outer_radius, RINGS + 1)
    flat = extruded(
        grid(radii, np.linspace(0.0, 2.0 * np.pi, SECTORS + 1)),
        np.sort([0.0, side * helicoid.inner_radius]),
    )
    radius, angle, height = flat.vertices.T
    bent = np.column_stack(
        [radius * np.cos(angle), radius * np.sin(angle),
         helicoid.level(flat.vertices[:, :2]) + height]
    )  # fmt: skip
    mesh = quadratic_mesh(Solid(bent, flat.tetrahedra))
    is_on = np.zeros(len(mesh.nodes), dtype=bool)
    is_on[: len(bent)] = height == 0.0
    return mesh, is_on


PROBLEM = Problem("PC1", "Thin helix that follows its pitch, interface alone", thin_helix, True)
