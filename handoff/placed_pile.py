"""A pile at its place in the ground, as the hand-over and the service stage see it.

Two kinds of pile exist, flat-ended in the plane and screw piles in space; everything that depends
on the shape of the pile is asked from here.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from handoff.facet_points import FacetPoints, whole_strength
from handoff.fe_mesh import FEMesh, make_mesh
from handoff.interface_transfer import FESurface, transferred_traction
from handoff.line_of_sight import Obstacle, screw_obstacle
from handoff.options import HandoffOptions
from handoff.screw_mesh import make_screw_mesh
from handoff.surface import SurfaceProfile
from handoff.surface_transfer import traction_on_surface
from handoff.synthetic import airy_stress, distance_to_pile, rim_stress
from install_mpm.conventions import Kinematics, rotation_matrix
from install_mpm.exact_patches import strength_shares
from install_mpm.ground import GroundProfile
from install_mpm.interface import force_on_pile
from install_mpm.options import Box
from install_mpm.pile import Pile, PilePart, buried_weight, surface_normals
from install_mpm.screw_history import driven
from install_mpm.screw_pile import ScrewPile, part_names
from install_mpm.screw_programme import rim_radius
from install_mpm.screw_record import weight_of
from install_mpm.screw_shape import distance_to_plates
from install_mpm.screw_surface import facet_normals
from install_mpm.state_file import InstalledState


class PlacedPile(Protocol):
    """What the stages after the installation have to know of a pile."""

    @property
    def kinematics(self) -> Kinematics:
        """Of the model that the pile belongs to."""

    @property
    def tip_depth(self) -> float:
        """Depth of the tip in m."""

    @property
    def width(self) -> float:
        """Width, or largest diameter, in m."""

    @property
    def half_width(self) -> float:
        """Distance in m from the axis to the soil at the ground surface."""

    @property
    def near(self) -> float:
        """Distance in m from the pile up to which the certificate has figures of their own."""

    @property
    def part_names(self) -> tuple[str, ...]:
        """Names of the parts of the surface, in the order of their numbers."""

    def mesh(
        self,
        box: Box,
        options: HandoffOptions,
        surface: SurfaceProfile,
        boundaries: Sequence[float] = (),
    ) -> FEMesh:
        """Return the mesh of the soil; see ``fe_mesh.make_mesh``."""

    def normals(self, facets: FacetPoints) -> np.ndarray:
        """Return the exact normals (n_i, dim), from soil to pile, at points on ``facets``."""

    def strength_share(self, facets: FacetPoints) -> np.ndarray:
        """Return the shear strength (n_i,) of the exact surface over that of its ``facets``."""

    def obstacle(self) -> Obstacle | np.ndarray:
        """Return the pile as what hides material points."""

    def distance(self, positions: np.ndarray) -> np.ndarray:
        """Return the distance (n,) in m of places in the soil from the pile."""

    def synthetic_stress(self, ground: GroundProfile, positions: np.ndarray) -> np.ndarray:
        """Return a steep self-equilibrated stress (n, 3, 3) in Pa around the pile."""

    def traction(
        self, ground: GroundProfile, installed: InstalledState, surface: FESurface
    ) -> np.ndarray:
        """Return the installed tractions (n_i, dim) in Pa at the points of ``surface``."""

    def rebound(self, installed: InstalledState) -> tuple[float, float]:
        """Return by how much (m, rad) the pile rose and turned while the rig let go of it."""

    def carried(self, installed: InstalledState) -> np.ndarray | None:
        """Return what the soil does to a pile that the rig has let go of, or None if it holds it.

        Force and moment (n_motions,) in N and N m about the axis at the ground surface.
        """

    def weight(self, water_table: float | None) -> float:
        """Return the weight in N of the modelled part of the pile below the ground surface."""


@dataclass(frozen=True)
class PlacedFlatPile:
    """A wall in plane strain or a round pile in axisymmetry."""

    pile: Pile
    tip_depth: float
    kinematics: Kinematics = Kinematics.PLANE_STRAIN

    @property
    def width(self) -> float:
        """Width or diameter in m."""
        return self.pile.width

    @property
    def half_width(self) -> float:
        """Half of it in m."""
        return self.pile.half_width

    @property
    def near(self) -> float:
        """One width in m."""
        return self.pile.width

    @property
    def part_names(self) -> tuple[str, ...]:
        """Names of the parts."""
        return tuple(part.name.lower() for part in PilePart)

    def mesh(
        self,
        box: Box,
        options: HandoffOptions,
        surface: SurfaceProfile,
        boundaries: Sequence[float] = (),
    ) -> FEMesh:
        """Return the mesh of triangles."""
        return make_mesh(self.pile, self.tip_depth, box, options, surface, boundaries)

    def normals(self, facets: FacetPoints) -> np.ndarray:
        """Return the normals of the parts."""
        return surface_normals(facets.parts)

    def strength_share(self, facets: FacetPoints) -> np.ndarray:
        """Return one: the facets are the surface."""
        return whole_strength(facets)

    def obstacle(self) -> Obstacle:
        """Return the outline of the pile."""
        return Obstacle(self.pile.half_width, -self.tip_depth)

    def distance(self, positions: np.ndarray) -> np.ndarray:
        """Return the distance (n,) in m from shaft and base."""
        return distance_to_pile(self.pile, self.tip_depth, positions)

    def synthetic_stress(self, ground: GroundProfile, positions: np.ndarray) -> np.ndarray:
        """Return the field of an Airy function at the corners of the tip."""
        return airy_stress(ground, self.pile, self.tip_depth, positions, self.kinematics)

    def traction(
        self, ground: GroundProfile, installed: InstalledState, surface: FESurface
    ) -> np.ndarray:
        """Return the tractions, carried over along base and shaft."""
        return transferred_traction(
            ground, installed.interface, surface.positions, surface.areas, surface.parts
        )

    def rebound(self, installed: InstalledState) -> tuple[float, float]:
        """Return zero: the rig still holds the pile."""
        return 0.0, 0.0

    def carried(self, installed: InstalledState) -> None:
        """Return None: the rig still holds the pile."""

    def weight(self, water_table: float | None) -> float:
        """Return the weight of half of the wall, or of the round pile."""
        return buried_weight(self.pile, self.tip_depth, self.kinematics, water_table)


@dataclass(frozen=True)
class PlacedScrewPile:
    """A screw pile in space; ``pile.embedment`` is the depth of its tip now."""

    pile: ScrewPile
    rotation: float
    """Angle in rad by which it has turned, right-handed about +z."""

    kinematics = Kinematics.THREE_D

    @property
    def tip_depth(self) -> float:
        """Depth of the tip in m."""
        return self.pile.embedment

    @property
    def width(self) -> float:
        """Diameter in m of the largest plate, or of the shaft."""
        return 2.0 * rim_radius(self.pile)

    @property
    def half_width(self) -> float:
        """Radius of the shaft in m."""
        return self.pile.shaft_radius

    @property
    def near(self) -> float:
        """Half a diameter in m."""
        return rim_radius(self.pile)

    @property
    def part_names(self) -> tuple[str, ...]:
        """Names of the parts."""
        return part_names(self.pile)

    def mesh(
        self,
        box: Box,
        options: HandoffOptions,
        surface: SurfaceProfile,
        boundaries: Sequence[float] = (),
    ) -> FEMesh:
        """Return the mesh of tetrahedra."""
        return make_screw_mesh(self.pile, self.rotation, box, options, surface, boundaries)

    def normals(self, facets: FacetPoints) -> np.ndarray:
        """Return the normals of shaft, tip and plates, with one at each corner of an edge."""
        turn = rotation_matrix(self.rotation, 3)
        normals, _ = facet_normals(self.pile, facets, facets.facet_parts, facets.coordinates @ turn)
        turned: np.ndarray = normals @ turn.T
        return turned

    def strength_share(self, facets: FacetPoints) -> np.ndarray:
        """Return the strength of the patches of the exact surface, as in the installation."""
        place = facets.coordinates @ rotation_matrix(self.rotation, 3)
        return strength_shares(self.pile, facets, facets.facet_parts, place)

    def obstacle(self) -> np.ndarray:
        """Return the core of shaft and plates."""
        return screw_obstacle(self.pile, self.rotation)

    def distance(self, positions: np.ndarray) -> np.ndarray:
        """Return the distance (n,) in m from shaft and plates."""
        place = positions @ rotation_matrix(self.rotation, 3)
        beside = np.maximum(np.linalg.norm(place[:, :2], axis=1) - self.pile.shaft_radius, 0.0)
        below = np.maximum(-self.tip_depth - place[:, 2], 0.0)
        distance: np.ndarray = np.minimum(
            np.hypot(beside, below), distance_to_plates(self.pile, place)
        )
        return distance

    def synthetic_stress(self, ground: GroundProfile, positions: np.ndarray) -> np.ndarray:
        """Return a field centred on places at the rim of the plates and at the tip."""
        return rim_stress(ground, self.pile, self.rotation, positions)

    def traction(
        self, ground: GroundProfile, installed: InstalledState, surface: FESurface
    ) -> np.ndarray:
        """Return the tractions, carried over part by part."""
        penetration = float(installed.pile.penetration)
        start = replace(self.pile, embedment=self.pile.embedment - penetration)
        return traction_on_surface(
            ground, start, installed.background_mesh, installed.interface, surface
        )

    def rebound(self, installed: InstalledState) -> tuple[float, float]:
        """Return rise and rotation since the last step in which the rig drove the pile."""
        history = driven(installed.history)
        if not len(history.travel):
            return 0.0, 0.0
        rise = history.penetration[-1] - installed.pile.penetration
        return float(rise), float(installed.pile.rotation - history.rotation[-1])

    def carried(self, installed: InstalledState) -> np.ndarray | None:
        """Return force and moment of the soil on the pile if the release has come to its end."""
        share = installed.history.release_share
        if not len(share) or share[-1] < 1.0:
            return None
        force = force_on_pile(installed.interface)
        moment = np.cross(installed.interface.position, force)
        return np.concatenate([force.sum(axis=0), moment.sum(axis=0)])

    def weight(self, water_table: float | None) -> float:
        """Return the weight of the pile below the surface; under water it is that of the case."""
        return weight_of(self.pile, self.tip_depth)
