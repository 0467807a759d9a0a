"""Installed against wished in place: curves as rows, headline figures, convergence statistics."""

from __future__ import annotations

import csv
import io
from typing import Any

import numpy as np

from install_mpm.conventions import Kinematics
from install_mpm.history import History
from install_mpm.pile import PilePart
from install_mpm.screw_history import driven
from install_mpm.state_file import InstalledState
from service_fe.cycles import accumulated
from service_fe.options import Cycles, Load, Release, Resume, Rotate
from service_fe.results import (
    LINEAR_WORK,
    Curve,
    ProgrammeResult,
    ServiceResult,
    characteristics,
)
from workflows.case import AnyCase
from workflows.comparison import has_ratio
from workflows.continuity import continuity_figures

COLUMNS = ("programme", "model", "displacement_m", "head_load_N", "iterations", "residual")

QUADRATIC_ORDER = 1.8
"""Order of convergence from which the end of a residual history counts as quadratic."""


def curves_csv(results: list[ServiceResult]) -> str:
    """Return all curves as CSV text: whole pile, displacement and load positive downward."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    for result in results:
        for entry in result.programmes:
            curve = entry.curve
            for k in range(len(curve.displacement)):
                writer.writerow(
                    [
                        entry.programme.name,
                        result.model,
                        repr(float(curve.displacement[k])),
                        repr(float(curve.head_load[k])),
                        int(curve.iterations[k]),
                        f"{curve.residual[k]:.3e}",
                    ]
                )
    return text.getvalue()


def headline(
    case: AnyCase, installed: InstalledState, service: ServiceResult, wished: ServiceResult
) -> dict[str, Any]:
    """Return the headline results of a run as plain data; names carry the SI unit."""
    installation = installation_figures(installed)
    return {
        "installation": installation,
        "service": {
            result.programme.name: programme_figures(
                result, wished.programme(result.programme.name), case.pile.width
            )
            for result in service.programmes
        },
        "continuity": continuity_figures(case, installation, service),
    }


def installation_figures(installed: InstalledState) -> dict[str, Any]:
    """Return depth and forces at the end of the installation (whole pile, a wall per metre run).

    Those of a screw pile are the last ones before the rig lets go.
    """
    history, points = installed.history, installed.material_points
    figures = {
        "penetration_m": float(installed.pile.penetration),
        "tip_depth_m": float(installed.pile.tip_depth),
        "steps": len(history.penetration),
        "material_points": len(points.mass),
        "smallest_volume_ratio": float(points.volume_ratio.min()),
        "largest_volume_ratio": float(points.volume_ratio.max()),
    }
    if installed.kinematics == Kinematics.THREE_D:
        last = driven(history)
        return figures | {
            "crowd_force_N": float(last.crowd_force[-1]),
            "torque_N m": float(last.torque[-1]),
        }
    return figures | {
        "crowd_force_N": float(history.crowd_force[-1]),
        f"{PilePart.BASE.name.lower()}_force_N": float(history.base_force[-1]),
        f"{PilePart.SHAFT.name.lower()}_force_N": float(history.shaft_force[-1]),
    }


def programme_figures(
    installed: ProgrammeResult, wished: ProgrammeResult, pile_width: float
) -> dict[str, Any]:
    """Return the figures of a programme for both models, and their ratio.

    A ratio is taken where both models start without head load, i.e. from the released pile.
    """
    programme = installed.programme
    if isinstance(programme, Cycles):
        return {
            "installed": _cyclic_figures(programme, installed.curve),
            "wished_in_place": _cyclic_figures(programme, wished.curve),
        }
    if isinstance(programme, Release | Resume | Load):
        return {
            "installed": _release_figures(installed.curve),
            "wished_in_place": _release_figures(wished.curve),
        }
    figures = {
        "installed": _curve_figures(installed, pile_width),
        "wished_in_place": _curve_figures(wished, pile_width),
    }
    if not has_ratio(programme):
        return figures
    ratios = {
        name: _ratio(value, figures["wished_in_place"][name])
        for name, value in figures["installed"].items()
    }
    names = {name: name.rsplit("_", 1)[0] for name in ratios}
    return {**figures, "ratio": {names[name]: value for name, value in ratios.items()}}


def _curve_figures(result: ProgrammeResult, pile_width: float) -> dict[str, float | None]:
    """Return stiffness and capacities; those of a rotation are moments, at 0.1 rad."""
    is_turned = isinstance(result.programme, Rotate)
    found = characteristics(result.curve, 1.0 if is_turned else pile_width)
    stiffness, load = ("N m/rad", "N m") if is_turned else ("N/m", "N")
    return {
        f"initial_stiffness_{stiffness}": found.initial_stiffness,
        f"capacity_{load}": found.capacity,
        f"tangent_capacity_{load}": found.tangent_capacity,
    }


def _release_figures(curve: Curve) -> dict[str, float]:
    return {
        "head_load_before_N": float(curve.head_load[0]),
        "displacement_m": float(curve.displacement[-1]),
    }


def _cyclic_figures(programme: Cycles, curve: Curve) -> dict[str, float]:
    """Return what one cycle and all cycles have left behind, at the mean load."""
    ends = accumulated(programme, curve)
    return {
        "cycles": programme.cycles,
        "rotation_after_first_cycle_rad": float(ends.rotation[1] - ends.rotation[0]),
        "accumulated_rotation_rad": float(ends.rotation[-1] - ends.rotation[0]),
        "accumulated_displacement_m": float(ends.displacement[-1] - ends.displacement[0]),
    }


def _ratio(installed: float | None, wished: float | None) -> float | None:
    return None if installed is None or not wished else installed / wished


def convergence(installed: InstalledState, results: list[ServiceResult]) -> dict[str, Any]:
    """Return how Newton's method converged in the installation and in each service model."""
    return {
        "installation": convergence_figures(installed.history),
        **{
            result.model: {
                entry.programme.name: {
                    **convergence_figures(entry.curve),
                    "settled_steps": int(np.count_nonzero(entry.curve.settled)),
                    "largest_viscous_share": float(entry.curve.viscous_share.max()),
                    **{name: int(getattr(entry.curve, name).sum()) for name in LINEAR_WORK},
                }
                for entry in result.programmes
            }
            for result in results
        },
    }


def convergence_figures(rows: History | Curve) -> dict[str, Any]:
    """Return the statistics of the steps that iterated.

    A step whose history is too short to show an order (it was nearly linear) has none, and is not
    counted in the share of quadratic steps.
    """
    steps = rows.iterations > 0
    order = rows.convergence_order[steps]
    known = order[np.isfinite(order)]
    return {
        "steps": int(steps.sum()),
        "steps_with_known_order": len(known),
        "share_quadratic": float((known >= QUADRATIC_ORDER).mean()) if len(known) else None,
        "median_order": float(np.median(known)) if len(known) else None,
        "largest_residual": float(rows.residual[steps].max()) if steps.any() else 0.0,
        "mean_iterations": float(rows.iterations[steps].mean()) if steps.any() else 0.0,
        "cuts": int(rows.cuts.sum()),
    }
