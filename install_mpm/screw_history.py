"""History of the installation of a screw pile: one row per load step."""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from install_mpm.record import Field


def _per_step(unit: str, doc: str, dtype: str = "float64", *, may_be_nan: bool = False) -> Field:
    return Field(("load_step",), unit, doc, dtype, may_be_nan)


def _added(unit: str, doc: str) -> Field:
    """Describe what older files do not have, or what is not there in every step."""
    return Field(("load_step",), unit, doc, may_be_nan=True, default=np.nan)


def _per_part(unit: str, doc: str) -> Field:
    return Field(("load_step", "part"), unit, doc)


class ScrewHistory(NamedTuple):
    """What happened in each accepted load step."""

    travel: Annotated[np.ndarray, _per_step("m", "travel of the rim, given and found, so far")]
    penetration: Annotated[np.ndarray, _per_step("m", "pile penetration at the end of the step")]
    rotation: Annotated[np.ndarray, _per_step("rad", "pile rotation, right-handed about +z")]
    release_share: Annotated[
        np.ndarray, _per_step("", "share of the rig's loads that has been taken off")
    ]
    phase: Annotated[
        np.ndarray,
        Field(("load_step",), "", "number of the phase from 0, the release last; -1: not recorded",
              "int64", default=-1),
    ]  # fmt: skip
    phase_share: Annotated[
        np.ndarray, _added("", "share of the phase that is done; NaN: not recorded")
    ]
    crowd_force: Annotated[
        np.ndarray,
        _per_step("N", "force that the rig applies downward: soil reaction less pile weight"),
    ]
    torque: Annotated[
        np.ndarray,
        _per_step("N m", "torque that the rig applies, positive in the sense that drives it down"),
    ]
    lateral_force: Annotated[
        np.ndarray,
        Field(("load_step", 2), "N", "horizontal force of the soil on the pile, x and y"),
    ]
    overturning_moment: Annotated[
        np.ndarray,
        Field(("load_step", 2), "N m", "moment of the soil on the pile about the x and y axis"),
    ]
    part_torque: Annotated[np.ndarray, _per_part("N m", "torque of the parts of the surface")]
    part_normal_torque: Annotated[
        np.ndarray, _per_part("N m", "share of it that comes from normal traction")
    ]
    part_force: Annotated[
        np.ndarray, _per_part("N", "upward force of the soil on the parts of the surface")
    ]
    far_force_mismatch: Annotated[
        np.ndarray,
        _per_step("", "force on the pile less supports and weight, over the sum of its parts"),
    ]
    far_moment_mismatch: Annotated[
        np.ndarray,
        _per_step("", "same of the moment, over the sum of force times distance from the axis"),
    ]
    rig_work: Annotated[np.ndarray, _per_step("J", "work of torque and vertical force in the step")]
    interface_work: Annotated[
        np.ndarray, _per_step("J", "work of the interface tractions on the slip in the step")
    ]
    soil_work: Annotated[np.ndarray, _per_step("J", "work of the stresses in the soil in the step")]
    weight_work: Annotated[np.ndarray, _per_step("J", "work of the weight of the soil in the step")]
    iterations: Annotated[np.ndarray, _per_step("", "Newton iterations", "int64")]
    residual: Annotated[np.ndarray, _per_step("", "relative out-of-balance force at acceptance")]
    convergence_order: Annotated[
        np.ndarray,
        _per_step("", "order of the last Newton iterations; NaN if too few", may_be_nan=True),
    ]
    cuts: Annotated[
        np.ndarray, _per_step("", "times the step was halved before it converged", "int64")
    ]
    empty_cells: Annotated[
        np.ndarray, _per_step("", "cells below the fill threshold beside filled ones", "int64")
    ]
    partly_filled_cells: Annotated[
        np.ndarray, _per_step("", "cells with points that are not interior", "int64")
    ]
    empty_integration_points: Annotated[
        np.ndarray, _per_step("", "integration points without a material point", "int64")
    ]
    injected_points: Annotated[
        np.ndarray, _per_step("", "material points made by splitting", "int64")
    ]
    merged_points: Annotated[
        np.ndarray, _per_step("", "material points that were merged into others", "int64")
    ]
    projected_points: Annotated[
        np.ndarray, _per_step("", "material points brought back from outside the mesh", "int64")
    ]
    smallest_cell_quality: Annotated[
        np.ndarray, _per_step("", "worst ratio 3 r_in / r_out of a cell, 1 is regular")
    ]
    smallest_volume_ratio: Annotated[np.ndarray, _per_step("", "smallest J of a material point")]
    largest_volume_ratio: Annotated[np.ndarray, _per_step("", "largest J of a material point")]
    advancement_ratio: Annotated[
        np.ndarray,
        _added("", "advance of the step per turn over the pitch of the lowest helix; NaN without"),
    ]
    mass_error: Annotated[
        np.ndarray, _added("", "relative change of the mass of all points by merging and splitting")
    ]
    volume_error: Annotated[np.ndarray, _added("", "the same of their volume; NaN: not recorded")]
    closed_volume: Annotated[
        np.ndarray,
        _added("m3", "openings of sand that closed beside sand under pressure; NaN: not recorded"),
    ]
    edge_torque: Annotated[
        np.ndarray,
        _added("N m", "by hand, of edges and rim of plates that the mesh holds as surfaces; not in "
                      "the torque; NaN: not stated"),
    ]  # fmt: skip
    edge_force: Annotated[
        np.ndarray, _added("N", "the same of the crowd force, positive against driving it down")
    ]
    pressure_scatter: Annotated[
        np.ndarray,
        _added("Pa", "mean pressure of points about that of their cell, root mean square within a "
                     "diameter of the pile"),
    ]  # fmt: skip
    winding_stress_change: Annotated[
        np.ndarray, _added("", "relative change of stress by winding the mesh back; NaN without")
    ]
    winding_force_change: Annotated[
        np.ndarray, _added("N", "change of the vertical force of that stress on the pile")
    ]
    winding_torque_change: Annotated[
        np.ndarray, _added("N m", "change of its torque, positive against driving the pile down")
    ]
    winding_energy_change: Annotated[
        np.ndarray, _added("J", "change of half of stress times elastic strain in the soil")
    ]
    residual_history: Annotated[
        np.ndarray,
        Field(("load_step", "iteration"), "", "relative residuals, NaN-padded", may_be_nan=True),
    ]


def driven(history: ScrewHistory) -> ScrewHistory:
    """Return the history of the steps in which the rig drove the pile, before it let go."""
    is_driven = history.release_share == 0.0
    return ScrewHistory(*(values[is_driven] for values in history))
