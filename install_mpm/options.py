"""Options of the installation stage: box, meshes, motion and numerics, each with unit and range."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

from annotated_types import Ge, Gt, Le, Lt

from install_mpm.conventions import Unit

Length = Annotated[float, Unit("m"), Gt(0)]
Share = Annotated[float, Gt(0), Le(1)]


@dataclass(frozen=True)
class Box:
    """The modelled ground and the empty layer above it into which soil can heave."""

    width: Length
    depth: Length
    headroom: Length


@dataclass(frozen=True)
class BackgroundMeshOptions:
    """Sizes of the background mesh, and how many material points each cell starts with."""

    size_at_pile: Length
    size_far: Length
    rigid_zone: Annotated[float, Unit("m"), Ge(0)] = 0.0
    points_per_direction: Annotated[int, Ge(1), Le(4)] = 2
    """Points per sub-region and direction: a triangle has 3 sub-regions, so 2 gives 12 points."""
    smallest_quality: Annotated[float, Ge(0), Lt(0.5)] = 0.0
    """The mesh is made anew at the pile's place before a step if a cell is worse than this (2 r_in
    / r_out, 1 is equilateral); 0 never.
    """


@dataclass(frozen=True)
class DiscretisationOptions:
    """What material points are to the equations of a step, and on which cells.

    ``docs/method.md`` compares the choices and says why the default is the default.
    """

    scheme: Literal["carriers", "quadrature"] = "carriers"
    """``carriers``: points carry the state to fixed integration points of the cells, with mean
    dilatation, injection and merging. ``quadrature``: points are the integration points, as in
    the paper.
    """
    cells: Literal["tri6", "tri3"] = "tri6"
    """Six-node triangles, or the three-node triangles of the paper."""
    cell_weighted: bool = False
    """With ``quadrature``: scale the volumes of the points of interior cells to the cell's."""


@dataclass(frozen=True)
class InstallationProgramme:
    """How the pile is driven: penetration in equal steps (0 m leaves the pile wished in place)."""

    penetration: Annotated[float, Unit("m"), Ge(0)]
    step: Length


@dataclass(frozen=True)
class Numerics:
    """Numerical parameters of the installation; the defaults are explained in docs/method.md."""

    tolerance: Annotated[float, Gt(0), Le(1e-6)] = 1e-9
    max_iterations: Annotated[int, Ge(3)] = 25
    patience: Annotated[int, Ge(1)] | None = None
    """Iterations in which the residual has to halve, else the step is cut; None: no such rule."""
    inner_tolerance: Annotated[float, Ge(0), Lt(1)] = 0.0
    """Relative residual to which GMRES solves the later linear systems of a step, with the factors
    of its first one; 0: every one is factorised.
    """
    max_cuts: Annotated[int, Ge(0)] = 6
    volumetric_term: Annotated[float, Ge(0)] = 0.1
    """Stiffness h_v of the volumetric term, of a step only, over Young's modulus."""
    fill_threshold: Share = 0.3
    soft_stiffness: Annotated[float, Ge(0)] = 1e-2
    """Stiffness, of a step only, of partly filled cells over Young's modulus and missing share."""
    open_stiffness: Annotated[float, Ge(0)] = 0.0
    """Stiffness, of a step only, of sand that has opened or may open over Young's modulus."""
    largest_correction: Annotated[float | None, Gt(0)] = None
    """Of a displacement component in an iteration, over the size of the cells; None: no limit."""
    second_start: bool = False
    """Begin a step again from rest once a correction of its first trial, the last displacement,
    increases the residual even when it is halved twice.
    """
    most_points_per_cell: Annotated[int, Ge(3)] = 48
    """Material points are merged in cells that hold more."""
    checkpoint_every: Annotated[int, Ge(1)] = 10
    linear_solver: str = "mumps"
    random_seed: int = 0


@dataclass(frozen=True)
class ScrewNumerics(Numerics):
    """Numerical parameters of an installation in space."""

    tolerance: Annotated[float, Gt(0), Le(1e-3)] = 1e-4
    """Sand that leaves the pile converges slowly from there on, in a few cells at its apex."""
    soft_stiffness: Annotated[float, Ge(0)] = 2e-2
    """As stiff in shear as in the plane: here partly filled cells do not resist their turning."""


@dataclass(frozen=True)
class ScrewMeshOptions:
    """Sizes of the background mesh around a screw pile; a cell is twice as fine as it is large."""

    size_at_edges: Length
    """Around leading and trailing edges, which govern the torque."""
    size_at_plate: Length
    size_at_shaft: Length
    size_far: Length
    edge_reach: Length
    """Distance from the edges within which cells have ``size_at_edges``."""
    growth: Annotated[float, Gt(0), Le(1)] = 0.45
    """Increase of the cell size per distance from edges, plates and shaft."""
    points_per_direction: Annotated[int, Ge(1), Le(3)] = 1
    """Points per sub-region and direction: a tetrahedron has 4 sub-regions, so 2 gives 32."""
    random_seed: Annotated[int, Ge(0)] = 0
