"""The facets of a mesh that lie on the pile, with the integration points on them."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from handoff.fe_mesh import FEMesh, pile_facets
from install_mpm.interface import facet_rule


class FacetPoints(NamedTuple):
    """Facets on the pile and the rule on them, the one of the installation: three points each."""

    coordinates: np.ndarray
    """Of all nodes of the mesh, (node, dim) in m."""
    nodes: np.ndarray
    """Of each facet: vertices, then mid-sides, (n, n_facet_nodes)."""
    facet_parts: np.ndarray
    """Part of the pile (n,) on which a facet lies."""
    shape_values: np.ndarray
    """Shape functions of a facet at its points, (n_facet_points, n_facet_nodes)."""
    weights: np.ndarray
    """Of the points (n_facet_points,), of a facet of unit size."""

    @property
    def positions(self) -> np.ndarray:
        """Positions (n_i, dim) in m of the points, facet by facet."""
        places = np.einsum("qa,fai->fqi", self.shape_values, self.coordinates[self.nodes])
        return places.reshape(-1, self.coordinates.shape[1])

    @property
    def parts(self) -> np.ndarray:
        """Part of the pile (n_i,) of each point."""
        return np.repeat(self.facet_parts, len(self.weights))

    def selected(self, chosen: np.ndarray) -> FacetPoints:
        """Return the facets that are ``chosen`` (n,) bool."""
        return self._replace(nodes=self.nodes[chosen], facet_parts=self.facet_parts[chosen])


NormalsOf = Callable[[FacetPoints], np.ndarray]
"""Normals (n_i, dim) of the exact surface, from soil to pile, at points on facets."""

ShareOf = Callable[[FacetPoints], np.ndarray]
"""Shear strength (n_i,) of the exact surface over that of its facets, at points on them."""


def whole_strength(facets: FacetPoints) -> np.ndarray:
    """Return the shares (n_i,) where facets are the surface itself: one."""
    return np.ones(len(facets.parts))


def facet_points(mesh: FEMesh) -> FacetPoints:
    """Return the integration points on the pile's facets of a mesh; there may be none."""
    facets = pile_facets(mesh)
    rule = facet_rule(mesh.facet_nodes.shape[1], 3)
    return FacetPoints(mesh.nodes, mesh.facet_nodes[facets], mesh.facet_tag[facets], *rule)
