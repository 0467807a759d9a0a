"""Balance of a step as a whole: resultants on the pile against those of supports and weight."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from install_mpm.interface import Contact


class Mismatch(NamedTuple):
    """How far the resultants on the pile are from what supports and loads say, relative."""

    force: float
    """Over the sum of the magnitudes of the forces on the pile."""
    moment: float
    """About the origin, over the sum of force times distance from the z axis."""


def far_field_mismatch(contact: Contact, nodes: np.ndarray, loads: np.ndarray) -> Mismatch:
    """Return the mismatch of all six resultants at the end of a step in space.

    ``loads`` (n_nodes, 3) in N are reactions and external forces on the soil, ``nodes`` (n_nodes,
    3) in m the places where they act then.  The measure of the moment is the torque that the forces
    on the pile would have if all of them acted around its axis.  Unlike the torque itself it does
    not vanish at rest, or where the torques of the parts cancel when the rig lets go.
    """
    size = np.linalg.norm(contact.force, axis=1)
    radius = np.linalg.norm(contact.position[:, :2], axis=1)
    force = contact.force.sum(axis=0) - loads.sum(axis=0)
    moment = np.cross(contact.position, contact.force).sum(axis=0)
    moment -= np.cross(nodes, loads).sum(axis=0)
    return Mismatch(
        float(np.linalg.norm(force) / (size.sum() or 1.0)),
        float(np.linalg.norm(moment) / (radius @ size or 1.0)),
    )
