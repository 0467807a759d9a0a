"""A rigid body turns in a disc of soil whose rim is fixed, and the mesh turns with it.

The torque is that of the support forces on the nodes of the body about the origin, at their places
at the end of the step.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple

import numpy as np

from install_mpm.background_mesh import BackgroundMesh
from install_mpm.constitutive.parameters import SoilParameters
from install_mpm.equilibrium import Prescribed
from install_mpm.ground import Ground
from install_mpm.interface import InterfaceElements, InterfacePoints
from install_mpm.mesh_motion import rotate, rotate_clockwise
from install_mpm.options import Numerics
from install_mpm.pile import PileMotion
from install_mpm.step import StepResult
from workflows.verification.body import Body, ProblemNotSolvedError, advance, make_body
from workflows.verification.disc_meshes import disc_mesh, nodes_on

STEP = np.deg2rad(5.0)
"""Rotation of a step in rad: the paper's."""


class MeshLaw(Enum):
    """How the mesh follows the body."""

    WHOLE = "whole"
    """All of it turns with the body, as in the paper; the rim has to map onto itself."""
    TAPERED = "tapered"
    """It turns with the body where the body is, and not at all at the rim."""


@dataclass(frozen=True)
class Disc:
    """Outlines of rim and body, (corners, 2) in m each, and the law of the mesh."""

    rim: np.ndarray
    hole: np.ndarray
    mesh_law: MeshLaw = MeshLaw.TAPERED

    @property
    def radii(self) -> tuple[float, float]:
        """Largest radius of the body and radius of the rim in m."""
        inner, outer = (float(np.hypot(*p.T).max()) for p in (self.hole, self.rim))
        return inner, outer

    def turned(self, mesh: BackgroundMesh, angle: float) -> BackgroundMesh:
        """Return the mesh after the body has turned by ``angle`` in all, anticlockwise in rad."""
        if self.mesh_law == MeshLaw.WHOLE:
            return rotate(mesh, angle)
        inner, outer = self.radii
        return rotate(mesh, angle, inner_radius=inner, outer_radius=outer)


class Turned(NamedTuple):
    """What the rotation has given, first axes (n_steps,); it may have ended early."""

    angle: np.ndarray
    """Rotation of the body in rad, anticlockwise."""
    torque: np.ndarray
    """On the body, in N m per metre run, in the sense of the rotation."""
    residuals: tuple[tuple[float, ...], ...]
    """Relative Newton residuals of each step."""
    body: Body
    """State after the last step."""
    failure: str
    """Why it has ended early; empty if it has not."""


def disc_body(
    disc: Disc,
    soil: SoilParameters,
    numerics: Numerics,
    interface: tuple[InterfaceElements, InterfacePoints] | None = None,
) -> Body:
    """Return the weightless and stress-free soil between body and rim."""
    mesh = disc_mesh(disc.rim, disc.hole)
    return make_body(
        mesh,
        Ground(0.0, 1.0, soil),
        numerics=numerics,
        is_soil=np.ones(len(mesh.cell_nodes), dtype=bool),
        interface=interface,
    )


def turn(
    disc: Disc,
    soil: SoilParameters,
    angle: float,
    *,
    numerics: Numerics | None = None,
    may_stop: bool = False,
    observe: Callable[[float, Body], None] = lambda angle, body: None,
) -> Turned:
    """Return the rotation of a rough body by ``angle`` in rad, in equal steps of 5 degrees or less.

    After every step ``observe`` is called with the rotation in rad and the state.

    Raises
    ------
    ProblemNotSolvedError
        If a step does not converge, unless it ``may_stop``.
    """
    body = disc_body(disc, soil, numerics or Numerics())
    driven = nodes_on(body.mesh, disc.hole)
    n_steps = max(1, int(np.ceil(abs(angle) / STEP - 1e-9)))
    angles, torques, residuals = angle / n_steps * np.arange(1, n_steps + 1), [], []
    failure = ""
    for number in range(n_steps):
        try:
            body, result = turn_once(body, disc, driven, angles[number], angle / n_steps)
        except ProblemNotSolvedError as error:
            if not may_stop:
                raise
            failure = str(error)
            break
        torques.append(torque(body.mesh.nodes[driven], result.equilibrium.reaction[driven]))
        residuals.append(tuple(result.equilibrium.newton.residuals))
        observe(angles[number], body)
    return Turned(angles[: len(torques)], np.array(torques), tuple(residuals), body, failure)


def turn_once(
    body: Body,
    disc: Disc,
    driven: np.ndarray,
    angle: float,
    step: float,
    *,
    motion: PileMotion | None = None,
    taken_along: float | None = None,
) -> tuple[Body, StepResult]:
    """Return the body after a step that takes the nodes ``driven`` to ``angle``, and the step.

    Without driven nodes an interface carries the ``motion`` of the rigid body to the soil, which
    may stay behind: in the first trial it turns by ``taken_along`` in rad, by default all the way.
    """
    nodes = body.mesh.nodes
    is_prescribed = np.zeros(nodes.shape, dtype=bool)
    is_prescribed[nodes_on(body.mesh, disc.rim)] = True
    is_prescribed[driven] = True
    displacement = np.zeros_like(nodes)
    displacement[driven] = rotate_clockwise(nodes[driven], -step) - nodes[driven]
    along = step if taken_along is None else taken_along
    body = body._replace(start=_first_trial(body, disc, along))
    return advance(
        body,
        Prescribed(is_prescribed, displacement),
        motion=motion or PileMotion(np.zeros(2)),
        move_mesh=lambda mesh: disc.turned(mesh, angle),
        name=f"rotation to {np.rad2deg(angle):.4g} degrees",
    )


def torque(position: np.ndarray, force: np.ndarray) -> float:
    """Return the moment in N m about the origin of forces (n, 2) at ``position`` (n, 2)."""
    return float((position[:, 0] * force[:, 1] - position[:, 1] * force[:, 0]).sum())


def _first_trial(body: Body, disc: Disc, step: float) -> np.ndarray:
    """Return the first trial displacement (n_nodes, 2) in m of a step.

    That of an annulus at small strain: the motion of the body in one row of cells would turn them
    over.  That of the step before would be nearer, so near that of three residuals above round-off
    the first is not yet in the range of quadratic convergence, and no order could be read off.
    """
    inner, outer = disc.radii
    radius = np.linalg.norm(body.mesh.reference_nodes, axis=1)
    share = (1.0 / radius**2 - 1.0 / outer**2) / (1.0 / inner**2 - 1.0 / outer**2)
    return _turned_each(body.mesh.nodes, np.clip(share, 0.0, 1.0) * step) - body.mesh.nodes


def _turned_each(vectors: np.ndarray, angles: np.ndarray) -> np.ndarray:
    """Return ``vectors`` (n, 2), each turned anticlockwise by its own angle (n,) in rad."""
    cosine, sine = np.cos(angles), np.sin(angles)
    x, z = vectors.T
    return np.column_stack([cosine * x - sine * z, sine * x + cosine * z])
