"""The installed screw pile in space, to be turned and zoomed: its surface and the ground around."""

from __future__ import annotations

import numpy as np
import plotly.graph_objects as go

from install_mpm.ground import GroundProfile
from workflows.interactive import AXIS, layout, single
from workflows.report_fields import symmetric_norm
from workflows.report_style import DIVERGING
from workflows.screw_frames import PileSurface, PointCloud
from workflows.screw_slices import mean_pressure_change
from workflows.screw_surface_pictures import TractionField, traction_fields

HEIGHT = 620
"""Of the view in pixels."""

MOST_POINTS = 12000
"""Material points in the view: more make the page slow to turn."""

GROUND_BEHIND = 0.0
"""The ground is cut by the vertical plane y = 0 m; what lies behind it is drawn."""

SCALES = {"magma_r": "Magma_r", "viridis": "Viridis", "RdBu_r": "RdBu_r"}
"""Names that plotly has for the colour maps of the still pictures."""


def view(surface: PileSurface, cloud: PointCloud, ground: GroundProfile) -> go.Figure:
    """Return the pile with the tractions on it, and the ground with its change of mean pressure.

    Buttons choose contact pressure or shear traction; the legend takes the ground away.
    """
    fields = traction_fields(surface)
    plot = go.Figure([_pile(surface, field) for field in fields] + [_ground(cloud, ground)])
    plot.data[1].visible = False
    axis = {**AXIS, "showbackground": False}
    plot.update_layout(
        **layout(HEIGHT) | {"legend": {"orientation": "h", "y": 0.0}},
        scene={
            "aspectmode": "data", "xaxis": {**axis, "title": "x (m)"},
            "yaxis": {**axis, "title": "y (m)"}, "zaxis": {**axis, "title": "z (m)"},
            "camera": {"eye": {"x": 0.5, "y": -1.5, "z": 0.5}},
        },
        updatemenus=[_choice(fields)],
    )  # fmt: skip
    return plot


def _pile(surface: PileSurface, field: TractionField) -> go.Mesh3d:
    """Return the pile with one traction (kPa) on its facets; grey where there is no ground."""
    corners = surface.corners.reshape(-1, 3)
    first = np.arange(0, len(corners), 3, dtype=np.int32)
    return go.Mesh3d(
        x=single(corners[:, 0]), y=single(corners[:, 1]), z=single(corners[:, 2]),
        i=first, j=first + 1, k=first + 2, name="pile",
        intensity=single(np.nan_to_num(field.values[:, 0])), intensitymode="cell",
        cmin=field.norm.vmin, cmax=field.norm.vmax, colorscale=SCALES[field.cmap],
        colorbar={"title": {"text": field.label, "side": "right"}, "x": 1.0, "len": 0.8},
        flatshading=True, hovertemplate=f"%{{intensity:.4g}} kPa<extra>{field.label}</extra>",
    )  # fmt: skip


def _ground(cloud: PointCloud, ground: GroundProfile) -> go.Scatter3d:
    """Return the material points behind the plane of the cut, thinned."""
    behind = np.flatnonzero(cloud.position[:, 1] > GROUND_BEHIND)
    chosen = behind[:: max(1, -(-len(behind) // MOST_POINTS))]
    values = mean_pressure_change(ground, cloud)
    norm = symmetric_norm(values[behind])
    label = "change of mean pressure (kPa)"
    return go.Scatter3d(
        x=single(cloud.position[chosen, 0]), y=single(cloud.position[chosen, 1]),
        z=single(cloud.position[chosen, 2]), mode="markers", name="ground", showlegend=True,
        marker={
            "size": 3, "color": single(values[chosen]), "colorscale": SCALES[DIVERGING],
            "cmin": norm.vmin, "cmax": norm.vmax,
            "colorbar": {"title": {"text": label, "side": "right"}, "x": 1.12, "len": 0.8},
        },
        hovertemplate="%{marker.color:.4g} kPa<br>%{x:.3g}, %{y:.3g}, %{z:.3g} m"
        f"<extra>{label}</extra>",
    )  # fmt: skip


def _choice(fields: tuple[TractionField, ...]) -> dict[str, object]:
    """Return the buttons that choose what is shown on the pile."""
    piles = list(range(len(fields)))
    return {
        "type": "buttons", "direction": "right", "x": 0.0, "y": 1.08, "xanchor": "left",
        "buttons": [
            {
                "label": field.label.partition(" (")[0], "method": "restyle",
                "args": [{"visible": [other is field for other in fields]}, piles],
            }
            for field in fields
        ],
    }  # fmt: skip
