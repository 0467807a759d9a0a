"""Picture of the tractions along the shaft of a screw pile before and after the hand-over."""

from __future__ import annotations

from typing import Any

from matplotlib.figure import Figure

from handoff.shaft_profile import AROUND, DOWNWARD, NORMAL, shaft_profiles
from install_mpm.screw_pile import part_names
from install_mpm.state_file import InstalledState
from workflows.report_style import INSTALLED, WISHED, grid, panels
from workflows.screw_case import ScrewCase

COMPONENTS = (
    (NORMAL, -1e-3, "contact pressure (kPa)"),
    (DOWNWARD, 1e-3, "downward shear on the soil (kPa)"),
    (AROUND, 1e-3, "shear around the axis (kPa)"),
)
"""Component of the traction, factor to the display unit, and label."""


def shaft_tractions(case: ScrewCase, installed: InstalledState, handed_off: Any) -> Figure:
    """Return the tractions along the shaft in material points and, balanced, in finite elements."""
    assert case.handoff is not None
    profiles = shaft_profiles(
        installed.interface,
        handed_off.interface,
        handed_off.state.interface_traction,
        part_names(case.pile).index("shaft"),
        case.handoff.size_at_pile,
    )
    figure, axes = panels(1, len(COMPONENTS), 10.0, 4.0, sharey=True)
    for here, (component, factor, label) in zip(axes[0], COMPONENTS, strict=True):
        for values, style, colour, name in (
            (profiles.material_points, "o", WISHED, "material points"),
            (profiles.finite_elements, "-", INSTALLED, "finite elements, in equilibrium"),
        ):
            traction = factor * values[:, component]
            here.plot(traction, profiles.height, style, color=colour, label=name, markersize=4.0)
        here.set(xlabel=label)
        grid(here)
    axes[0, 0].set(ylabel="z (m)")
    axes[0, 0].legend()
    return figure
