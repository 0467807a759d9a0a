"""Bodies under gravity that grows from nothing, in an environment of any strength of gravity.

The step knows one strength of gravity; the mass of the material points is therefore that of the
unit weight of the load step, as in a centrifuge that spins up.
"""

from __future__ import annotations

import numpy as np

from install_mpm.background_mesh import BackgroundMesh
from install_mpm.conventions import GRAVITY
from install_mpm.equilibrium import Prescribed
from install_mpm.location import locate
from install_mpm.material_points import MaterialPoints
from install_mpm.step import StepResult
from workflows.verification.body import Body, ProblemNotSolvedError, advance

MOST_HALVINGS = 3
"""A load step that does not converge is cut into at most two to this power."""


def with_weight_of_points(body: Body) -> Body:
    """Return the body with cells that weigh what their points weigh."""
    return body._replace(model=body.model._replace(has_weight_of_points=True))


def load_gravity(
    body: Body,
    unit_weight: float,
    shares: tuple[float, float],
    prescribed: Prescribed,
    *,
    name: str = "body",
    halvings: int = 0,
) -> tuple[Body, StepResult, tuple[tuple[float, ...], ...]]:
    """Return the body at the second of two ``shares`` of gravity, the step, and its residuals.

    ``unit_weight`` in N/m^3 is that of the undeformed body.  A step that does not converge is tried
    again from rest, then in halves.

    Raises
    ------
    ProblemNotSolvedError
        If the step does not converge in parts either.
    """
    points = body.points
    initial_volume = points.volume / points.volume_ratio
    mass = initial_volume * unit_weight * shares[1] / GRAVITY
    loaded = body._replace(points=points._replace(mass=mass))
    for start in (body.start, np.zeros_like(body.start)):
        try:
            moved, result = advance(loaded._replace(start=start), prescribed, name=name)
        except ProblemNotSolvedError:
            continue
        return moved, result, (tuple(result.equilibrium.newton.residuals),)
    if halvings == MOST_HALVINGS:
        raise ProblemNotSolvedError(f"{name}: gravity of {shares[1]:.4f} is not carried")
    histories: tuple[tuple[float, ...], ...] = ()
    middle = 0.5 * (shares[0] + shares[1])
    for part in ((shares[0], middle), (middle, shares[1])):
        body, result, history = load_gravity(
            body, unit_weight, part, prescribed, name=name, halvings=halvings + 1
        )
        histories += history
    return body, result, histories


def mesh_to(body: Body, mesh: BackgroundMesh) -> Body:
    """Return the body on ``mesh``, with its points located there again."""
    points = MaterialPoints(*(np.array(field) for field in body.points))
    locate(points, mesh)
    return body._replace(points=points, mesh=mesh)
