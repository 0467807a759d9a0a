"""The case of a screw pile: one TOML file that describes ground, pile and installation in space."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from handoff.options import HandoffOptions
from handoff.screw_mesh import largest_size
from install_mpm.constitutive.parameters import CoulombInterface
from install_mpm.conventions import Kinematics
from install_mpm.ground import GroundProfile
from install_mpm.options import Box, ScrewMeshOptions, ScrewNumerics
from install_mpm.screw_pile import Helix, ScrewPile, edge_thickness
from install_mpm.screw_pile_mesh import WALL_SIDES
from install_mpm.screw_programme import (
    ProgrammeError,
    ScrewProgramme,
    deepest_advance,
    phase_motion,
    rim_radius,
)
from install_mpm.screw_setup import lowest_tip
from service_fe.options import ServiceOptions
from workflows.comparison import ComparisonOptions, check_comparison
from workflows.cross_checks import (
    check_ground,
    check_interface,
    check_programmes,
    check_solver,
)
from workflows.errors import CaseError

LARGEST_ON_PLATE = 3.5
"""Largest cell size on a plate over its thickness; coarser meshes fail or have flat cells."""

LARGEST_ON_SHAFT = 2.0
"""Largest cell size on the shaft over its radius."""

LARGEST_AT_EDGES = 2.5
"""Largest cell size at the edges over the thickness of the plate there."""

LARGEST_AT_NOSE = 1.0
"""The same of rounded edges: a quarter turn takes a facet at least, an arc of 0.8 thicknesses."""

LARGEST_ON_SURFACE = 1.6
"""Largest cell size on a plate held as a surface over its width from shaft to rim."""

LARGEST_STEP = 0.25
"""Largest travel of the rim in a step over the size of the cells at the edges."""

NARROWEST_BOX = 2.5
"""Least radius of the box over the diameter of the largest plate."""


@dataclass(frozen=True)
class ScrewCase:
    """Everything that an installation in space depends on."""

    title: str
    """What the results are called; a results directory belongs to one title."""
    kinematics: Kinematics = field(default=Kinematics.THREE_D, kw_only=True)
    ground: GroundProfile
    pile: ScrewPile
    interface: CoulombInterface
    box: Box
    background_mesh: ScrewMeshOptions
    installation: ScrewProgramme
    numerics: ScrewNumerics
    handoff: HandoffOptions | None = None
    """Without it and ``service`` the run ends after the installation."""
    service: ServiceOptions | None = None
    comparison: ComparisonOptions | None = None
    """Without it the ratios installed over wished in place have no range."""

    @property
    def final_tip_depth(self) -> float:
        """Largest depth in m of the pile tip by the given motions."""
        return self.pile.embedment + deepest_advance(self.pile, self.installation)[1]


def check_screw_case(case: ScrewCase) -> None:
    """Check what single keys cannot tell, before anything is meshed.

    Raises
    ------
    CaseError
        Naming the keys, their values and the remedy, at the first contradiction.
    """
    if case.kinematics != Kinematics.THREE_D:
        raise CaseError('kinematics of a screw pile is "three_d"; leave the key out')
    _check_helices(case.pile)
    _check_programme(case)
    _check_box(case)
    _check_sizes(case)
    check_ground(case)
    check_interface(case)
    check_solver(case)
    _check_service(case)
    check_comparison(case, check_screw_case)


def _check_service(case: ScrewCase) -> None:
    if (case.handoff is None) != (case.service is None):
        given, missing = ("service", "handoff") if case.handoff is None else ("handoff", "service")
        raise CaseError(
            f"[{given}] is there without [{missing}]; give both to load the pile in service, or "
            "neither to stop after the installation"
        )
    if case.handoff is None or case.service is None:
        return
    if any(helix.is_surface for helix in case.pile.helices):
        raise CaseError(
            'pile.helices with plate = "surface" cannot be handed over to finite elements; leave '
            'out [handoff] and [service] to stop after the installation, or take plate = "solid"'
        )
    check_programmes(case.service, case.kinematics)
    limit = largest_size(case.pile)
    if case.handoff.size_at_pile > limit:
        raise CaseError(
            f"handoff.size_at_pile {case.handoff.size_at_pile:g} m cannot hold the shaft and the "
            f"plates of the pile; take at most {limit:g} m"
        )
    if case.handoff.size_far < case.handoff.size_at_pile:
        raise CaseError(
            f"handoff.size_far {case.handoff.size_far:g} m is smaller than handoff.size_at_pile "
            f"{case.handoff.size_at_pile:g} m; exchange the two"
        )


def _check_helices(pile: ScrewPile) -> None:
    top = 0.0
    for number, helix in enumerate(sorted(pile.helices, key=lambda h: h.height), 1):
        key = f"pile.helices[{number}]"
        if helix.diameter <= pile.shaft_diameter:
            raise CaseError(
                f"{key}.diameter {helix.diameter:g} m is not larger than pile.shaft_diameter "
                f"{pile.shaft_diameter:g} m; a plate has to stand out from the shaft"
            )
        if helix.pitch <= helix.thickness:
            raise CaseError(
                f"{key}.pitch {helix.pitch:g} m is not larger than its thickness "
                f"{helix.thickness:g} m; the turns of the plate would run into each other"
            )
        if helix.is_surface:
            _check_surface(key, helix)
        if helix.edge_thickness is not None:
            _check_taper(key, helix)
        bottom = helix.height - helix.thickness / 2.0
        if bottom < max(top, pile.tip_length):
            where = "the conical tip" if top <= pile.tip_length else "the helix below"
            raise CaseError(
                f"{key}.height {helix.height:g} m puts its leading edge into {where} or below "
                "the tip; raise it"
            )
        top = helix.height + helix.pitch * helix.turns + helix.thickness / 2.0
    if top >= pile.embedment:
        raise CaseError(
            f"pile.embedment {pile.embedment:g} m leaves the top of the uppermost helix, "
            f"{top:g} m above the tip, out of the ground; start deeper"
        )


def _check_surface(key: str, helix: Helix) -> None:
    for name, value, is_shaped in (
        ("edges", f'"{helix.edges}"', helix.edges != "blunt"),
        ("edge_thickness", f"{helix.edge_thickness or 0.0:g} m", helix.edge_thickness is not None),
    ):
        if is_shaped:
            raise CaseError(
                f"{key}.{name} is {value}, but a mesh that holds the plate as a surface has no "
                f'edges to shape; leave {name} out, or take plate = "solid"'
            )


def _check_taper(key: str, helix: Helix) -> None:
    if helix.edge_thickness is not None and helix.edge_thickness > helix.thickness:
        raise CaseError(
            f"{key}.edge_thickness {helix.edge_thickness:g} m is more than the thickness "
            f"{helix.thickness:g} m; an edge is as thick as the plate or thinner"
        )
    if 2.0 * helix.taper_angle > helix.winding:
        raise CaseError(
            f"{key}.taper_angle {np.degrees(helix.taper_angle):g} deg from both edges is more than "
            f"the plate winds ({np.degrees(helix.winding):g} deg); make it smaller"
        )


def _check_programme(case: ScrewCase) -> None:
    programme = case.installation
    try:
        for phase in programme.phases:
            phase_motion(case.pile, phase)
    except ProgrammeError as error:
        raise CaseError(f"installation.phases: {error}") from error
    if not programme.phases:
        raise CaseError("installation.phases is empty; add an [[installation.phases]] table")
    sides = programme.reset_angle / (2.0 * np.pi / WALL_SIDES)
    if abs(sides - round(sides)) > 1e-9:
        raise CaseError(
            f"installation.reset_angle is {np.degrees(programme.reset_angle):g} deg, but the outer "
            f"wall has sides of {360 / WALL_SIDES:g} deg; take a multiple of that"
        )
    highest = case.pile.embedment + deepest_advance(case.pile, programme)[0]
    if highest <= case.pile.highest_plate:
        raise CaseError(
            "installation.phases pull the pile up until its uppermost helix leaves the ground; "
            "pull less, or start deeper"
        )


def _check_box(case: ScrewCase) -> None:
    rim, box = rim_radius(case.pile), case.box
    if box.width < NARROWEST_BOX * 2.0 * rim:
        raise CaseError(
            f"box.width {box.width:g} m is less than {NARROWEST_BOX:g} diameters of the largest "
            f"plate; make it at least {NARROWEST_BOX * 2.0 * rim:g} m"
        )
    if case.final_tip_depth > lowest_tip(case.pile, box):
        raise CaseError(
            f"installation.phases take the tip to {case.final_tip_depth:g} m, less than a diameter "
            "above the bottom of the box; make box.depth at least "
            f"{case.final_tip_depth + 2.0 * rim:g} m (it is {box.depth:g} m)"
        )


def _check_sizes(case: ScrewCase) -> None:
    pile, mesh = case.pile, case.background_mesh
    if mesh.size_at_shaft > LARGEST_ON_SHAFT * pile.shaft_radius:
        raise CaseError(
            f"background_mesh.size_at_shaft {mesh.size_at_shaft:g} m is too coarse for a shaft of "
            f"{pile.shaft_diameter:g} m; take at most {LARGEST_ON_SHAFT * pile.shaft_radius:g} m"
        )
    smallest = mesh.size_at_edges
    for helix in pile.helices:
        if helix.is_surface:
            _check_size_on_surface(pile, helix, mesh)
            continue
        edge = edge_thickness(helix)
        at_edges = LARGEST_AT_NOSE if helix.edges == "rounded" else LARGEST_AT_EDGES
        for key, size, limit in (
            ("size_at_plate", mesh.size_at_plate, LARGEST_ON_PLATE * helix.thickness),
            ("size_at_edges", mesh.size_at_edges, at_edges * edge),
        ):
            if size > limit:
                raise CaseError(
                    f"background_mesh.{key} {size:g} m cannot hold a plate {helix.thickness:g} m "
                    f"thick ({edge:g} m at its {helix.edges} edges); take at most {limit:g} m, or "
                    'plate = "surface"'
                )
        smallest = min(smallest, 2.0 * edge)
    if case.installation.step > LARGEST_STEP * smallest:
        raise CaseError(
            f"installation.step {case.installation.step:g} m moves the edges more than "
            f"{LARGEST_STEP:g} of a cell at once; take at most {LARGEST_STEP * smallest:g} m, "
            "or coarser cells at the edges"
        )


def _check_size_on_surface(pile: ScrewPile, helix: Helix, mesh: ScrewMeshOptions) -> None:
    limit = LARGEST_ON_SURFACE * (helix.radius - pile.shaft_radius)
    for key, size in (("size_at_plate", mesh.size_at_plate), ("size_at_edges", mesh.size_at_edges)):
        if size > limit:
            raise CaseError(
                f"background_mesh.{key} {size:g} m is too coarse for a plate that stands out by "
                f"{helix.radius - pile.shaft_radius:g} m; take at most {limit:g} m"
            )
