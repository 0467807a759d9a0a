"""The certificate of a hand-over: figures, each beside the limit that it has to keep."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from typing import Any, NamedTuple

import numpy as np

from handoff.admissible import YieldCorrections, yield_values
from handoff.equilibration import EquilibrationReport, EquilibriumProblem
from handoff.fe_state_file import FEState
from handoff.figure import Figure, relative_difference
from handoff.geostatic import geostatic_state
from handoff.options import HandoffOptions
from handoff.pile_figures import reaction_figures, relaxation_figures
from handoff.placed_pile import PlacedPile
from handoff.state_transfer import FALLBACK_FROM, StateMap, map_errors
from handoff.tensor_arrays import relative_norm
from install_mpm.conventions import GRAVITY
from install_mpm.ground import GroundProfile, unit_weights
from install_mpm.material_points import cauchy_stress
from install_mpm.state_file import InstalledState

MAX_FALLBACK_SHARE = 0.01
MAX_VOLUME_DIFFERENCE = 0.005
MAX_YIELD_VIOLATION = 1e-6


@dataclass(frozen=True)
class Certificate:
    """All figures by name; forces are for the whole pile, a wall per metre run."""

    figures: dict[str, Figure]


def as_dict(certificate: Certificate) -> dict[str, dict[str, Any]]:
    """Return the certificate as plain data: name to value, unit, meaning, limit and is_met."""
    return {
        name: {**asdict(figure), "is_met": figure.is_met}
        for name, figure in certificate.figures.items()
    }


def as_json(certificate: Certificate) -> str:
    """Return the text of ``certificate.json``."""
    return json.dumps(as_dict(certificate), indent=2) + "\n"


def failed_checks(certificate: Certificate) -> list[str]:
    """Return one sentence for each figure that does not keep its limit."""
    return [
        f"{name} is {figure.value:.3g} {figure.unit}".rstrip()
        + f", more than {figure.limit:.3g}: {figure.meaning}"
        for name, figure in certificate.figures.items()
        if not figure.is_met
    ]


class Evidence(NamedTuple):
    """What a certificate is made from."""

    installed: InstalledState
    ground: GroundProfile
    placed: PlacedPile
    problem: EquilibriumProblem
    options: HandoffOptions
    state_map: StateMap
    corrections: YieldCorrections
    transferred: FEState
    """The state before the equilibration."""
    balanced: FEState
    """The state after the equilibration."""
    report: EquilibrationReport


def certify(evidence: Evidence) -> Certificate:
    """Return the certificate of a hand-over."""
    pile = (evidence.installed, evidence.placed, evidence.problem)
    states = (evidence.transferred, evidence.balanced)
    return Certificate(
        {
            **_synthetic_figures(evidence),
            **_distance_figures(evidence.state_map),
            **_nearest_figure(evidence),
            **_yield_figures(evidence),
            **_equilibrium_figures(evidence),
            **reaction_figures(*pile, states, evidence.options),
            **relaxation_figures(*pile[1:], states, evidence.options),
            **_volume_figures(evidence),
        }
    )


def _synthetic_figures(evidence: Evidence) -> dict[str, Figure]:
    placed, ground = evidence.placed, evidence.ground
    targets = evidence.problem.integration_positions
    everywhere, near = map_errors(
        placed.synthetic_stress(ground, evidence.installed.material_points.position),
        placed.synthetic_stress(ground, targets),
        evidence.state_map,
        evidence.problem.integration_volumes,
        placed.distance(targets) <= placed.near,
    )
    what = "relative L2 error of a synthetic equilibrated field sampled at the material points"
    limit = evidence.options.max_synthetic_error
    return {
        "synthetic_error": Figure(everywhere, "", what, limit),
        "synthetic_error_near_pile": Figure(
            near, "", f"{what}, within {placed.near:.3g} m of the pile", limit
        ),
    }


def _distance_figures(state_map: StateMap) -> dict[str, Figure]:
    distance = state_map.relative_distance[np.isfinite(state_map.relative_distance)]
    far = state_map.geostatic_share > 0.0
    what = "distance to the nearest material point over the size of those around"
    return {
        "nearest_distance_median": Figure(float(np.median(distance)), "", f"{what}, median"),
        "nearest_distance_p99": Figure(
            float(np.percentile(distance, 99)), "", f"{what}, 99th percentile", FALLBACK_FROM
        ),
        "nearest_distance_max": Figure(float(distance.max()), "", f"{what}, largest"),
        "fallback_targets": Figure(
            float(far.sum()), "", "integration points blended with the geostatic state"
        ),
        "fallback_share": Figure(
            float(far.mean()), "", "the same over all integration points", MAX_FALLBACK_SHARE
        ),
    }


def _nearest_figure(evidence: Evidence) -> dict[str, Figure]:
    stress = evidence.transferred.cauchy_stress
    points = cauchy_stress(evidence.installed.material_points)
    nearest = points[evidence.state_map.weights.nearest]
    difference = relative_norm(nearest - stress, stress, evidence.problem.integration_volumes)
    what = "cross-check: stress of the nearest material point against the fit, relative L2"
    return {"nearest_difference": Figure(difference, "", what)}


def _yield_figures(evidence: Evidence) -> dict[str, Figure]:
    corrections, balanced = evidence.corrections, evidence.balanced
    stress = np.linalg.norm(balanced.cauchy_stress, axis=(1, 2)).max()
    violation = max(float(yield_values(evidence.ground, balanced).max()), 0.0) / stress
    what = "stress change over deviatoric stress at the points returned to the yield surface"
    return {
        "yield_correction_share": Figure(
            corrections.share, "", "integration points returned to the yield surface over all"
        ),
        "yield_correction_mean": Figure(corrections.mean, "", f"{what}, mean"),
        "yield_correction_max": Figure(corrections.largest, "", f"{what}, largest"),
        "yield_violation": Figure(
            violation,
            "",
            "largest yield function over largest stress after equilibration",
            MAX_YIELD_VIOLATION,
        ),
    }


def _equilibrium_figures(evidence: Evidence) -> dict[str, Figure]:
    problem, report = evidence.problem, evidence.report
    undisturbed = geostatic_state(
        evidence.ground,
        problem.integration_positions,
        problem.interface_positions,
        problem.interface_normals,
        problem.interface_facet_normals,
    )
    what = "out-of-balance force over the weight of the soil"
    limit = evidence.options.max_out_of_balance
    return {
        "out_of_balance_geostatic": Figure(
            problem.out_of_balance(undisturbed), "", f"{what}: geostatic stress on this mesh"
        ),
        "out_of_balance_before": Figure(report.out_of_balance_before, "", f"{what}: transferred"),
        "out_of_balance_after": Figure(
            report.out_of_balance_after, "", f"{what}: equilibrated", limit
        ),
        "equilibration_stress_change": Figure(
            report.stress_change, "", "relative L2 stress change in the equilibration"
        ),
        "equilibration_displacement": Figure(
            report.largest_displacement, "m", "largest nodal displacement in the equilibration"
        ),
        "pile_displacement": Figure(
            report.pile_displacement / evidence.placed.width,
            "",
            "largest displacement of the pile in the equilibration over its width",
            evidence.options.max_pile_displacement,
        ),
    }


def _volume_figures(evidence: Evidence) -> dict[str, Figure]:
    points = evidence.installed.material_points
    density = unit_weights(evidence.ground)[evidence.balanced.material] / GRAVITY
    volumes_fe = evidence.problem.integration_volumes
    volume_fe, mass_fe = float(volumes_fe.sum()), float(density @ volumes_fe)
    figures: dict[str, Figure] = {}
    for name, unit, mpm, fe in (
        ("volume", "m^3", float(points.volume.sum()), volume_fe),
        ("mass", "kg", float(points.mass.sum()), mass_fe),
    ):
        figures[f"{name}_mpm"] = Figure(mpm, unit, f"{name} of the material points")
        figures[f"{name}_fe"] = Figure(fe, unit, f"{name} of the finite elements")
        figures[f"{name}_difference"] = Figure(
            relative_difference(fe, mpm),
            "",
            f"{name}, finite elements against material points",
            MAX_VOLUME_DIFFERENCE,
        )
    return figures
