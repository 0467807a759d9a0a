"""Checks between the values of a case: geometry that cannot be, meshes that cannot resolve it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from install_mpm.conventions import Kinematics
from service_fe.loading import contradiction
from service_fe.options import IN_THE_PLANE, ServiceOptions
from workflows.comparison import check_comparison
from workflows.errors import CaseError

if TYPE_CHECKING:
    from workflows.case import Case
    from workflows.screw_case import ScrewCase

LARGEST_STEP = 0.5
"""Largest step over the smallest cell: the pile must not pass more than half a cell at once."""

HEAVE_MARGIN = 2.0
"""Headroom over the mean heave of the box; beside the pile the ground rises more than that."""


def check(case: Case) -> None:
    """Check what single keys cannot tell.

    Raises
    ------
    CaseError
        Naming the keys, their values and the remedy, at the first contradiction.
    """
    _check_kinematics(case)
    _check_discretisation(case)
    check_ground(case)
    _check_geometry(case)
    _check_mesh_sizes(case)
    _check_headroom(case)
    _check_step(case)
    check_programmes(case.service, case.kinematics)
    check_interface(case)
    check_solver(case)
    check_comparison(case, check)


def _check_kinematics(case: Case) -> None:
    if case.kinematics == Kinematics.THREE_D:
        raise CaseError(
            'kinematics is "three_d", but the stages are two-dimensional; '
            'use "plane_strain" or "axisymmetric"'
        )


def _check_discretisation(case: Case) -> None:
    options = case.discretisation
    if options.cell_weighted and options.scheme != "quadrature":
        raise CaseError(
            "discretisation.cell_weighted scales points that are integration points; set "
            'discretisation.scheme = "quadrature", or leave it out'
        )
    is_round = case.kinematics == Kinematics.AXISYMMETRIC
    if options.scheme == "carriers":
        if is_round and options.cells == "tri3":
            raise CaseError(
                'discretisation.cells is "tri3": its one integration point does not integrate the '
                'hoop stress of a ring exactly; use "tri6", or the scheme "quadrature"'
            )
        return
    least = 1 + (options.cells == "tri6") + is_round
    if case.background_mesh.points_per_direction < least:
        raise CaseError(
            f"background_mesh.points_per_direction is "
            f"{case.background_mesh.points_per_direction}, too few for points that are integration "
            f"points of such cells; make it at least {least}"
        )


def check_ground(case: Case | ScrewCase) -> None:
    """Check that the ground bears its own stress, and that adhesion has a strength to go by.

    Raises
    ------
    CaseError
        Naming the layer, its depth and the remedy.
    """
    from install_mpm.geostatic import first_beyond_strength
    from install_mpm.ground import strata
    from install_mpm.soil_strength import has_undrained_shear_strength

    beyond = first_beyond_strength(case.ground, case.box.depth)
    if beyond is not None:
        layer, depth = beyond
        raise CaseError(
            f"the K0 stress of {layer.name!r} exceeds the strength of its soil "
            f"({layer.soil.model}) {depth:g} m deep; take k0 nearer to 1 or a stronger soil"
        )
    for stratum in strata(case.ground):
        layer = stratum.layer
        beside_pile = stratum.top < case.final_tip_depth
        has_strength = has_undrained_shear_strength(layer.soil)
        if case.interface.adhesion_factor > 0.0 and beside_pile and not has_strength:
            raise CaseError(
                f"interface.adhesion_factor is {case.interface.adhesion_factor:g}, but the soil of "
                f"{layer.name!r} beside the pile ({layer.soil.model}) has no undrained shear "
                "strength; give the interface a friction_angle or a cohesion instead"
            )


def _check_geometry(case: Case) -> None:
    pile, box = case.pile, case.box
    if pile.half_width + case.background_mesh.rigid_zone >= box.width:
        raise CaseError(
            f"pile.half_width {pile.half_width:g} m (with background_mesh.rigid_zone) does not fit "
            f"into box.width {box.width:g} m; make the box wider"
        )
    margin = pile.width
    if case.final_tip_depth + margin > box.depth:
        raise CaseError(
            f"pile.embedment {pile.embedment:g} m and installation.penetration "
            f"{case.installation.penetration:g} m take the tip to {case.final_tip_depth:g} m, less "
            f"than a pile width above the bottom of the box; make box.depth at least "
            f"{case.final_tip_depth + margin:g} m (it is {box.depth:g} m)"
        )


def _check_headroom(case: Case) -> None:
    box, half_width = case.box, case.pile.half_width
    heave = half_width * case.installation.penetration / (box.width - half_width)
    least = max(HEAVE_MARGIN * heave, case.background_mesh.size_at_pile)
    if box.headroom < least:
        raise CaseError(
            f"box.headroom {box.headroom:g} m is too low for the ground that the pile displaces; "
            f"make it at least {least:.2g} m"
        )


def _check_mesh_sizes(case: Case) -> None:
    half_width = case.pile.half_width
    for section, options in (("background_mesh", case.background_mesh), ("handoff", case.handoff)):
        fine, coarse = options.size_at_pile, options.size_far
        if coarse < fine:
            raise CaseError(
                f"{section}.size_far {coarse:g} m is smaller than {section}.size_at_pile "
                f"{fine:g} m; exchange the two"
            )
        if fine > half_width:
            raise CaseError(
                f"{section}.size_at_pile {fine:g} m is larger than half the pile width "
                f"({half_width:g} m); make it {half_width / 2:g} m or smaller"
            )
        if coarse > min(case.box.width, case.box.depth):
            raise CaseError(
                f"{section}.size_far {coarse:g} m is larger than the box; "
                f"make it {min(case.box.width, case.box.depth) / 4:g} m or smaller"
            )


def _check_step(case: Case) -> None:
    step, size = case.installation.step, case.background_mesh.size_at_pile
    if step > LARGEST_STEP * size:
        raise CaseError(
            f"installation.step {step:g} m is larger than half the smallest cell "
            f"(background_mesh.size_at_pile {size:g} m); "
            f"make it {LARGEST_STEP * size:g} m or smaller"
        )


def check_interface(case: Case | ScrewCase) -> None:
    """Check that the interface has what its tensile strength needs.

    Raises
    ------
    CaseError
        If it lacks the smoothing.
    """
    law = case.interface
    if law.tensile_strength is not None and law.smoothing_stress == 0.0:
        raise CaseError(
            f"interface.tensile_strength {law.tensile_strength:g} Pa needs an "
            "interface.smoothing_stress, over which adhesion falls to zero as the interface opens; "
            'set it, e.g. to "100 Pa"'
        )


def check_programmes(service: ServiceOptions, kinematics: Kinematics) -> None:
    """Check the programmes of the service stage against each other and the kind of pile.

    Raises
    ------
    CaseError
        At the first contradiction.
    """
    if not service.programmes:
        raise CaseError(
            "service.programmes is empty; add at least one [[service.programmes]] table"
        )
    wrong = contradiction(service.programmes)
    if wrong is not None:
        raise CaseError(f"service.programmes: {wrong}")
    if service.numerics.damping and service.numerics.viscosity:
        raise CaseError(
            "service.numerics gives both damping and viscosity; viscosity is there in every step, "
            "and damping in none that is accepted: set one of them to 0"
        )
    for programme in service.programmes:
        if kinematics != Kinematics.THREE_D and not isinstance(programme, IN_THE_PLANE):
            raise CaseError(
                f"service.programmes: {programme.name!r} is of kind {programme.kind!r}, which is "
                'for a pile in space; use "release" or "displace", or a screw pile'
            )


def check_solver(case: Case | ScrewCase) -> None:
    """Check that the linear solver is known.

    Raises
    ------
    CaseError
        If it is not.
    """
    from install_mpm.linear_solvers import SOLVERS

    if case.numerics.linear_solver not in SOLVERS:
        raise CaseError(
            f"numerics.linear_solver is {case.numerics.linear_solver!r}; "
            f"use one of {', '.join(SOLVERS)}"
        )
