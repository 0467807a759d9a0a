"""A rigid body turns and advances in a closed prism of soil, and the mesh turns with it, in space.

The motion of the body reaches the soil through an interface, or through driven nodes.  The mesh
takes the whole of the rotation at the body and none at the wall; it is wound back by whole sides of
the wall.  All surfaces of the body run along themselves, so the mesh need not follow its advance.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from install_mpm.background_mesh import BackgroundMesh
from install_mpm.conventions import rotation_matrix
from install_mpm.equilibrium import Prescribed
from install_mpm.mesh_motion import ScrewZones, screw
from install_mpm.pile import PileMotion
from install_mpm.step import StepResult
from workflows.verification.body import Body, advance
from workflows.verification.solid_surfaces import Normals, placed

ON_PLANE = 1e-9
"""Distance in m within which a node lies on a surface."""


class Prism(NamedTuple):
    """The space that soil and body fill."""

    inner_radius: float
    """Within it the mesh turns with the body, in m."""
    outer_radius: float
    """Of the corners of the wall, in m."""
    sides: int
    """Of the wall."""
    levels: tuple[float, float]
    """Of floor and ceiling, in m."""

    def moved(self, mesh: BackgroundMesh, angle: float) -> BackgroundMesh:
        """Return the mesh after the body has turned by ``angle`` in all, in rad."""
        side = 2.0 * np.pi / self.sides
        zones = ScrewZones(self.inner_radius, self.outer_radius, self.levels, self.levels)
        return screw(mesh, 0.0, angle, side * np.round(angle / side), zones)

    def supports(self, mesh: BackgroundMesh) -> np.ndarray:
        """Return which dofs are held (n_nodes, 3): all at the wall, and z at floor and ceiling."""
        reference = mesh.reference_nodes
        is_held = np.zeros(reference.shape, dtype=bool)
        is_held[self._is_on_wall(reference)] = True
        bottom, top = self.levels
        z = reference[:, 2]
        is_held[(z < bottom + ON_PLANE) | (z > top - ON_PLANE), 2] = True
        return is_held

    def _is_on_wall(self, nodes: np.ndarray) -> np.ndarray:
        half = np.pi / self.sides
        angle = np.mod(np.arctan2(nodes[:, 1], nodes[:, 0]), 2.0 * half) - half
        distance = np.linalg.norm(nodes[:, :2], axis=1) * np.cos(angle)
        is_on: np.ndarray = distance > self.outer_radius * np.cos(half) - ON_PLANE
        return is_on


class Driven(NamedTuple):
    """How the motion of the rigid body reaches the soil."""

    normals: Normals | None = None
    """Exact normals of its surface, if there is an interface."""
    nodes: np.ndarray | None = None
    """Otherwise: nodes (n,) that move with it."""


class Screwed(NamedTuple):
    """What a step has given."""

    body: Body
    torque: float
    """Of the soil on the rigid body about the z axis against its rotation, in N m."""
    force: float
    """Of the soil on the rigid body along the z axis, in N."""
    pressure: float
    """Mean normal pressure on the interface in Pa; zero without one."""
    result: StepResult


def screw_once(
    body: Body, prism: Prism, driven: Driven, angle: float, step: float, lift: float = 0.0
) -> Screwed:
    """Return a step in which the rigid body turns by ``step`` (rad) to ``angle`` and rises.

    ``lift`` is its vertical motion in the step in m.
    """
    nodes = body.mesh.nodes
    motion = PileMotion(np.array([0.0, 0.0, lift]), step)
    is_prescribed, displacement = prism.supports(body.mesh), np.zeros_like(nodes)
    if driven.nodes is not None:
        is_prescribed[driven.nodes] = True
        turn = rotation_matrix(step, 3) - np.eye(3)
        displacement[driven.nodes] = nodes[driven.nodes] @ turn.T + motion.translation
    moved, result = advance(
        body,
        Prescribed(is_prescribed, displacement),
        motion=motion,
        move_mesh=lambda mesh: prism.moved(mesh, angle),
        name=f"rotation to {np.degrees(angle):.4g} degrees",
    )
    torque, force, pressure = _resultants(body, result, driven)
    if driven.normals is None:
        start = _carried(result.equilibrium.displacement, nodes, moved.mesh.nodes)
        moved = moved._replace(start=start)
    else:  # the body slips: the soil next to it stays where it is
        interface = placed(moved.interface, body.model.elements, moved.mesh, driven.normals)
        moved = moved._replace(interface=interface, start=np.zeros_like(nodes))
    return Screwed(moved, -np.sign(step or 1.0) * torque, force, pressure, result)


def _resultants(body: Body, result: StepResult, driven: Driven) -> tuple[float, float, float]:
    """Return moment about the z axis and force along it on the rigid body, and mean pressure."""
    equilibrium = result.equilibrium
    position, force, pressure = equilibrium.contact.position, equilibrium.contact.force, 0.0
    if driven.nodes is None:
        pressure = float(-np.average(equilibrium.traction[:, 2], weights=body.interface.area))
    else:
        position = (body.mesh.nodes + equilibrium.displacement)[driven.nodes]
        force = -equilibrium.reaction[driven.nodes]
    moment = position[:, 0] * force[:, 1] - position[:, 1] * force[:, 0]
    return float(moment.sum()), float(force[:, 2].sum()), pressure


def _carried(displacement: np.ndarray, before: np.ndarray, after: np.ndarray) -> np.ndarray:
    """Return nodal vectors (n, 3) turned about the z axis with the nodes, as first trial."""
    angle = np.arctan2(after[:, 1], after[:, 0]) - np.arctan2(before[:, 1], before[:, 0])
    cosine, sine = np.cos(angle), np.sin(angle)
    x, y, z = displacement.T
    return np.column_stack([cosine * x - sine * y, sine * x + cosine * y, z])
