"""The facets of a mesh that lie on the pile, with the integration points on them.

They are those of the installation, three on a facet.  On a triangle the products of a traction that
grows with depth and quadratic functions are cubic, which three points do not integrate.  There a
point stands for the mean of the displacement, weighted by the linear function L_q that is one at
the point and zero at the two others,

    u_q = int L_q u dA / int L_q dA ,

and the nodal forces are its dual: a traction that is linear on the facet is integrated exactly, so
undisturbed ground is in balance.  The mean of a linear displacement is its value at the point.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from handoff.fe_mesh import FEMesh, pile_facets
from install_mpm.interface import facet_rule


class FacetPoints(NamedTuple):
    """Facets on the pile and the rule on them."""

    coordinates: np.ndarray
    """Of all nodes of the mesh, (node, dim) in m."""
    nodes: np.ndarray
    """Of each facet: vertices, then mid-sides, (n, n_facet_nodes)."""
    facet_parts: np.ndarray
    """Part of the pile (n,) on which a facet lies."""
    shape_values: np.ndarray
    """Shape functions of a facet at its points, or their means, (n_facet_points, n_facet_nodes)."""
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
    values, weights = facet_rule(mesh.facet_nodes.shape[1], 3)
    if values.shape[1] == 6:
        values = _mean_values(values)
    nodes, parts = mesh.facet_nodes[facets], mesh.facet_tag[facets]
    return FacetPoints(mesh.nodes, nodes, parts, values, weights)


def _mean_values(values: np.ndarray) -> np.ndarray:
    """Return the means (3, 6), weighted by L_q, of the functions with these ``values`` (3, 6).

    By int l_0^a l_1^b l_2^c dA = 2 A a! b! c! / (a + b + c + 2)! of the linear functions l of the
    vertices, with L_0 = 2 l_0 - 1 / 3.
    """
    is_near = values[:, :3] > 0.0  # the vertex beside which a point lies
    is_beside = is_near | np.roll(is_near, -1, axis=1)  # a mid-side has the vertices k and k + 1
    vertices = np.where(is_near, 1 / 5, -1 / 10)
    return np.hstack([vertices, np.where(is_beside, 7 / 15, 1 / 15)])
