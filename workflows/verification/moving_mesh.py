"""PA6: a mesh moves through soil at rest under a uniform stress, and nothing changes.

A disc of soil lies inside a larger mesh, which moves by two cells or turns by 45 degrees and takes
over the stress of the material points where it then is.  Among cells full of soil a uniform stress
has no resultant at a node.  With the material points as integration points it has one: their
quadrature error, which is reported and not bounded.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np

from install_mpm import carriers
from install_mpm.constitutive.parameters import HenckyElastic
from install_mpm.conventions import Unit
from install_mpm.discretisation import Scheme
from install_mpm.equilibrium import Prescribed
from install_mpm.ground import Ground
from install_mpm.location import locate
from install_mpm.material_points import MaterialPoints, cauchy_stress
from install_mpm.mesh_motion import rotate
from install_mpm.options import Numerics
from install_mpm.step import StepResult
from workflows.verification.body import Body, MoveMesh, advance, make_body
from workflows.verification.disc_meshes import circle, disc_mesh
from workflows.verification.problem import Check, Outcome, Problem, at_most
from workflows.verification.rigid_rotation import with_stress

SIDES = 48
SOIL_SHARE = 0.55
"""Radius of the soil over that of the mesh: it stays inside when the mesh moves by two cells."""
DENSITY = 2000.0
"""In kg/m^3, for the statement on mass; its weight does not act."""
UNCHANGED = 1e-10

Stress = Annotated[float, Unit("Pa")]


def moving_mesh(
    *,
    R: Annotated[float, Unit("m")] = 2.0,
    E: Stress = 10e6,
    nu: float = 0.3,
    sigma_xx: Stress = -100e3,
    sigma_yy: Stress = -50e3,
    tau_xy: Stress = 20e3,
) -> Outcome:
    """Return what the motion of a mesh of radius R changes in soil at rest."""
    cell = 2.0 * R * np.sin(np.pi / SIDES)
    moves: dict[str, MoveMesh] = {
        "two cells": lambda mesh: mesh._replace(nodes=mesh.nodes + np.array([2.0 * cell, 0.0])),
        "45 degrees": lambda mesh: rotate(mesh, np.deg2rad(45.0)),
    }
    components = sigma_xx, sigma_yy, tau_xy
    full = SOIL_SHARE * R - cell
    checks: list[Check] = []
    remarks, residuals = [], []
    for name, move in moves.items():
        soil = HenckyElastic(E, nu)
        own, history = _unchanged(name, _soil(Scheme.CARRIERS, R, soil, components), move, full)
        checks += own
        residuals.append(history)
        quadrature, _ = _moved(_soil(Scheme.QUADRATURE, R, soil, components), move)
        _, result = _equilibrium(quadrature, full)
        remarks.append(
            f"mesh moved by {name}: with the material points as integration points the"
            f" out-of-balance force is {100.0 * result.equilibrium.newton.residuals[0]:.2g} % of"
            " the support forces"
        )
    return Outcome(tuple(checks), remarks=tuple(remarks), residual_histories=tuple(residuals))


def _soil(
    scheme: Scheme, radius: float, soil: HenckyElastic, components: tuple[float, float, float]
) -> Body:
    """Return a disc of soil in the middle of a mesh of ``radius``, under a uniform stress."""
    mesh = disc_mesh(circle(radius, SIDES))
    centroid = mesh.nodes[mesh.cell_nodes[:, :3]].mean(axis=1)
    is_soil = np.linalg.norm(centroid, axis=1) < SOIL_SHARE * radius
    body = make_body(
        mesh,
        Ground(0.0, 1.0, soil),
        scheme=scheme,
        numerics=Numerics(tolerance=1e-10),
        is_soil=is_soil,
    )
    return with_stress(body, soil, components)


def _moved(body: Body, move: MoveMesh) -> tuple[Body, int]:
    """Return the body with its mesh moved, and how many points were outside it."""
    points = MaterialPoints(*(np.array(field) for field in body.points))
    mesh = move(body.mesh)
    outside = locate(points, mesh)
    return body._replace(points=points, mesh=mesh), outside


def _equilibrium(body: Body, full: float) -> tuple[Body, StepResult]:
    """Return a step at rest: only nodes among cells within the radius ``full`` are free."""
    mesh = body.mesh
    reach = np.linalg.norm(mesh.nodes[mesh.cell_nodes], axis=2).max(axis=1)
    is_held = np.zeros(len(mesh.nodes), dtype=bool)
    is_held[mesh.cell_nodes[reach > full]] = True
    at_rest = Prescribed(np.repeat(is_held[:, None], 2, axis=1), np.zeros_like(mesh.nodes))
    return advance(body, at_rest, name="soil at rest")


def _unchanged(
    name: str, body: Body, move: MoveMesh, full: float
) -> tuple[list[Check], tuple[float, ...]]:
    """Return the checks of one motion, and the residuals of the step at rest after it."""
    before = body.points
    moved, outside = _moved(body, move)
    drift = np.abs(moved.points.position - before.position).max()
    heavy = moved.points._replace(mass=DENSITY * moved.points.volume)
    given = carriers.give_state(heavy, moved.mesh, body.model, body.gradient)
    loss = given.points.mass.sum() / (DENSITY * before.volume.sum()) - 1.0
    after, result = _equilibrium(moved, full)
    stress = cauchy_stress(before)[0]
    change = np.abs(cauchy_stress(after.points) - stress).max() / np.abs(stress).max()
    growth = after.points.volume.sum() / before.volume.sum() - 1.0
    quantities = (
        ("points outside the mesh", outside, 0.0),
        ("motion of the material points in m", drift, 0.0),
        ("relative change of mass", abs(loss), UNCHANGED),
        ("out-of-balance force over support forces", result.equilibrium.newton.residuals[0],
         UNCHANGED),
        ("change of stress over its largest component", change, UNCHANGED),
        ("relative change of volume", abs(growth), UNCHANGED),
    )  # fmt: skip
    checks = [
        at_most(f"mesh moved by {name}: {text}", float(value), bound)
        for text, value, bound in quantities
    ]
    return checks, tuple(result.equilibrium.newton.residuals)


PROBLEM = Problem(
    "PA6", "Mesh moving through soil at rest under uniform stress", moving_mesh, is_quick=True
)
