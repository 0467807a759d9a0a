"""The certificate of a hand-over: figures, each beside the limit that it has to keep."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from handoff.admissible import YieldCorrections, yield_values
from handoff.equilibration import EquilibrationReport, EquilibriumProblem
from handoff.fe_state_file import FEState
from handoff.geostatic import geostatic_state
from handoff.interface_transfer import pile_forces
from handoff.options import HandoffOptions
from handoff.state_transfer import FALLBACK_FROM, StateMap
from handoff.synthetic import relative_norm, synthetic_errors
from install_mpm.conventions import GRAVITY
from install_mpm.ground import Ground
from install_mpm.material_points import MaterialPoints, cauchy_stress
from install_mpm.pile import SYMMETRY_FACTOR, Pile, PilePart
from install_mpm.state_file import InstalledState

MAX_FALLBACK_SHARE = 0.01
MAX_VOLUME_DIFFERENCE = 0.005
MAX_YIELD_VIOLATION = 1e-6


@dataclass(frozen=True)
class Figure:
    """One number of the certificate; it keeps its limit if it is not larger."""

    value: float
    unit: str
    meaning: str
    limit: float | None = None

    @property
    def is_met(self) -> bool:
        """Whether the limit is kept; a figure without limit is for information."""
        return self.limit is None or bool(self.value <= self.limit)


@dataclass(frozen=True)
class Certificate:
    """All figures by name; forces are for the whole pile, per metre run."""

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


def certify(
    installed: InstalledState,
    ground: Ground,
    pile: Pile,
    problem: EquilibriumProblem,
    options: HandoffOptions,
    state_map: StateMap,
    corrections: YieldCorrections,
    transferred: FEState,
    balanced: FEState,
    report: EquilibrationReport,
) -> Certificate:
    """Return the certificate, from the states before and after the equilibration."""
    points = installed.material_points
    return Certificate(
        {
            **_synthetic_figures(installed, ground, pile, problem, state_map, options),
            **_distance_figures(state_map),
            **_nearest_figure(points, problem, state_map, transferred),
            **_yield_figures(ground, corrections, balanced),
            **_equilibrium_figures(ground, problem, report, options),
            **_reaction_figures(installed, problem, transferred, balanced, options),
            **_volume_figures(points, ground, problem),
        }
    )


def _synthetic_figures(
    installed: InstalledState,
    ground: Ground,
    pile: Pile,
    problem: EquilibriumProblem,
    state_map: StateMap,
    options: HandoffOptions,
) -> dict[str, Figure]:
    everywhere, near = synthetic_errors(
        ground,
        pile,
        float(installed.pile.tip_depth),
        state_map,
        installed.material_points.position,
        problem.integration_positions,
        problem.integration_volumes,
    )
    meaning = "relative L2 error of a synthetic equilibrated field sampled at the material points"
    limit = options.max_synthetic_error
    return {
        "synthetic_error": Figure(everywhere, "", meaning, limit),
        "synthetic_error_near_pile": Figure(
            near, "", f"{meaning}, within one pile width of the pile", limit
        ),
    }


def _distance_figures(state_map: StateMap) -> dict[str, Figure]:
    distance = state_map.relative_distance[np.isfinite(state_map.relative_distance)]
    what = "distance to the nearest material point over its size"
    far = state_map.geostatic_share > 0.0
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


def _nearest_figure(
    points: MaterialPoints, problem: EquilibriumProblem, state_map: StateMap, transferred: FEState
) -> dict[str, Figure]:
    nearest = cauchy_stress(points)[state_map.weights.nearest]
    difference = relative_norm(
        nearest - transferred.cauchy_stress, transferred.cauchy_stress, problem.integration_volumes
    )
    meaning = "cross-check: stress of the nearest material point less transferred stress, relative"
    return {"nearest_difference": Figure(difference, "", meaning)}


def _yield_figures(
    ground: Ground, corrections: YieldCorrections, balanced: FEState
) -> dict[str, Figure]:
    stress = np.linalg.norm(balanced.cauchy_stress, axis=(1, 2)).max()
    violation = max(float(yield_values(ground, balanced).max()), 0.0) / stress
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


def _equilibrium_figures(
    ground: Ground,
    problem: EquilibriumProblem,
    report: EquilibrationReport,
    options: HandoffOptions,
) -> dict[str, Figure]:
    undisturbed = geostatic_state(
        ground,
        problem.integration_positions,
        problem.interface_positions,
        problem.interface_normals,
    )
    what = "out-of-balance force over the weight of the soil"
    return {
        "out_of_balance_geostatic": Figure(
            problem.out_of_balance(undisturbed), "", f"{what}: geostatic stress on this mesh"
        ),
        "out_of_balance_before": Figure(report.out_of_balance_before, "", f"{what}: transferred"),
        "out_of_balance_after": Figure(
            report.out_of_balance_after, "", f"{what}: equilibrated", options.max_out_of_balance
        ),
        "equilibration_stress_change": Figure(
            report.stress_change, "", "relative L2 stress change in the equilibration"
        ),
        "equilibration_displacement": Figure(
            report.largest_displacement, "m", "largest nodal displacement in the equilibration"
        ),
    }


def _reaction_figures(
    installed: InstalledState,
    problem: EquilibriumProblem,
    transferred: FEState,
    balanced: FEState,
    options: HandoffOptions,
) -> dict[str, Figure]:
    points = installed.interface
    geometry = problem.interface_normals, problem.interface_areas, problem.interface_parts
    forces = {
        "mpm": pile_forces(
            points.traction, points.normal, points.area * points.is_active, points.part
        ),
        "transferred": pile_forces(transferred.interface_traction, *geometry),
        "equilibrated": pile_forces(balanced.interface_traction, *geometry),
    }
    total = SYMMETRY_FACTOR * float(installed.pile.reaction[-1])
    figures = {
        f"pile_{part.name.lower()}_force_{stage}": Figure(
            force[part], "N", f"upward soil reaction on the {part.name.lower()}: {stage}"
        )
        for stage, force in forces.items()
        for part in PilePart
    }
    after = sum(forces["equilibrated"].values())
    figures["pile_reaction_mpm"] = Figure(total, "N", "upward soil reaction on the pile: mpm")
    figures["pile_reaction_equilibrated"] = Figure(
        after, "N", "upward soil reaction on the pile: equilibrated"
    )
    figures["pile_reaction_change"] = Figure(
        _relative_difference(after, total),
        "",
        "pile reaction, finite elements against material points",
        options.max_reaction_change,
    )
    return figures


def _volume_figures(
    points: MaterialPoints, ground: Ground, problem: EquilibriumProblem
) -> dict[str, Figure]:
    volumes = float(points.volume.sum()), float(problem.integration_volumes.sum())
    masses = float(points.mass.sum()), ground.unit_weight / GRAVITY * volumes[1]
    return {
        "volume_mpm": Figure(volumes[0], "m^3", "volume of the material points"),
        "volume_fe": Figure(volumes[1], "m^3", "volume of the finite elements"),
        "volume_difference": Figure(
            _relative_difference(volumes[1], volumes[0]),
            "",
            "volume, finite elements against material points",
            MAX_VOLUME_DIFFERENCE,
        ),
        "mass_mpm": Figure(masses[0], "kg", "mass of the material points"),
        "mass_fe": Figure(masses[1], "kg", "mass of the finite elements"),
        "mass_difference": Figure(
            _relative_difference(masses[1], masses[0]),
            "",
            "mass, finite elements against material points",
            MAX_VOLUME_DIFFERENCE,
        ),
    }


def _relative_difference(value: float, reference: float) -> float:
    """Return |value - reference| over |reference|; zero where both are zero."""
    difference = abs(value - reference)
    return difference / abs(reference) if reference else difference
