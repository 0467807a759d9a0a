"""A small ground with a pile, and installed states made by hand."""

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest

from handoff.fe_mesh import FEMesh, cell_areas, make_mesh
from handoff.geostatic import elastic_strain_of, geostatic_traction
from handoff.options import HandoffOptions
from handoff.placed_pile import PlacedFlatPile
from handoff.surface import level_surface
from install_mpm.constitutive import coulomb_interface, dispatch
from install_mpm.constitutive.parameters import CoulombInterface, VonMises
from install_mpm.conventions import GRAVITY, Kinematics
from install_mpm.ground import Ground, geostatic_stress
from install_mpm.interface import InterfacePoints
from install_mpm.material_points import MaterialPoints
from install_mpm.options import Box
from install_mpm.pile import Pile, PilePart, surface_normals
from install_mpm.state_file import InstalledState, PileState

TIP_DEPTH = 2.0
STRENGTH = 20e3


@dataclass(frozen=True)
class Site:
    """Everything a hand-over is given, apart from the installed state."""

    pile = Pile(half_width=0.5, embedment=TIP_DEPTH, unit_weight=18e3)
    box = Box(width=4.0, depth=5.0, headroom=0.5)
    ground = Ground(
        unit_weight=18e3, k0=0.8, soil=VonMises(200.0 * STRENGTH, 0.49, STRENGTH, 500.0)
    )
    interface = CoulombInterface(2e8, 2e7, adhesion_factor=0.5)
    options = HandoffOptions(size_at_pile=0.1, size_far=0.5)
    placed = PlacedFlatPile(pile, TIP_DEPTH)

    def mesh(self, size: float = 0.1, surface=None, coarsening: float = 5.0) -> FEMesh:
        options = HandoffOptions(size_at_pile=size, size_far=coarsening * size)
        return make_mesh(self.pile, TIP_DEPTH, self.box, options, surface or level_surface())


@pytest.fixture(scope="session")
def site() -> Site:
    return Site()


def scattered_points(
    mesh: FEMesh, ground: Ground, per_cell: int = 12, seed: int = 0
) -> MaterialPoints:
    """Material points of undisturbed ground, at random places, equally many in each cell."""
    random = np.random.default_rng(seed)
    corners = mesh.nodes[mesh.cell_nodes[:, :3]]
    shares = random.dirichlet([1.0, 1.0, 1.0], size=(len(corners), per_cell))
    position = np.einsum("cpk,ckd->cpd", shares, corners).reshape(-1, 2)
    volume = np.repeat(cell_areas(mesh) / per_cell, per_cell)
    stress = geostatic_stress(ground, position[:, 1], 1)
    material = np.zeros(len(position), dtype=np.int64)
    state = dispatch.initial_state(ground.soil, -position[:, 1], stress)
    return MaterialPoints(
        position=position,
        displacement=np.zeros_like(position),
        mass=volume * ground.unit_weight / GRAVITY,
        volume=volume,
        volume_ratio=np.ones(len(position)),
        elastic_log_strain=elastic_strain_of(ground, material, stress, state),
        kirchhoff_stress=stress,
        state_variables=state,
        material=material,
        cell=material,
        reference_coordinates=shares.reshape(-1, 3)[:, :2],
    )


def interface_points(site: Site, per_part: int = 30) -> InterfacePoints:
    """Interface points with geostatic traction, on a shaft that reaches above the surface."""
    base = (np.arange(per_part) + 0.5) / per_part * site.pile.half_width
    length = TIP_DEPTH + site.box.headroom
    shaft = (np.arange(3 * per_part) + 0.5) / (3 * per_part) * length - TIP_DEPTH
    part = np.repeat([PilePart.BASE, PilePart.SHAFT], [len(base), len(shaft)]).astype(np.int64)
    position = np.concatenate(
        [
            np.column_stack([base, np.full(len(base), -TIP_DEPTH)]),
            np.column_stack([np.full(len(shaft), site.pile.half_width), shaft]),
        ]
    )
    normal = surface_normals(part)
    area = np.where(part == 0, site.pile.half_width / len(base), length / len(shaft))
    covered = (position[:, 1] < 0.0).astype(np.float64)
    return InterfacePoints(
        position=position,
        normal=normal,
        area=area,
        traction=geostatic_traction(site.ground, position, normal) * covered[:, None],
        parameters=coulomb_interface.pack(site.interface, np.full(len(part), STRENGTH)),
        part=part,
        covered=covered,
    )


def installed_state(
    points: MaterialPoints, interface: InterfacePoints, tip_depth: float = TIP_DEPTH
) -> InstalledState:
    """An installed state of which only what the hand-over reads is filled."""
    normal_force = interface.traction * (interface.area * interface.covered)[:, None]
    upward = -(
        normal_force[:, 1] * interface.normal[:, 1] + normal_force[:, 0] * interface.normal[:, 0]
    )
    filled = dict.fromkeys(InstalledState._fields) | {
        "material_points": points,
        "interface": interface,
        "pile": PileState(
            penetration=np.array(0.0),
            rotation=np.array(0.0),
            tip_depth=np.array(tip_depth),
            reaction=np.array([0.0, upward.sum()]),
        ),
        "case_text": 'title = "made by hand"\n',
        "kinematics": Kinematics.PLANE_STRAIN,
    }
    return InstalledState(**filled)


@pytest.fixture(scope="session")
def undisturbed(site: Site) -> InstalledState:
    """Installed state of a pile that was not moved."""
    return installed_state(scattered_points(site.mesh(0.09), site.ground), interface_points(site))


def integration_points(mesh: FEMesh) -> tuple[np.ndarray, np.ndarray]:
    """Positions and volumes of three integration points in each cell."""
    corners = mesh.nodes[mesh.cell_nodes[:, :3]]
    shares = np.full((3, 3), 1.0 / 6.0) + 0.5 * np.eye(3)
    return np.einsum("qk,ckd->cqd", shares, corners).reshape(-1, 2), np.repeat(
        cell_areas(mesh) / 3.0, 3
    )


def pile_surface(mesh: FEMesh) -> SimpleNamespace:
    """Two Gauss points on each pile facet: positions, areas, normals, parts."""
    is_pile = mesh.facet_tag >= 0
    ends = mesh.nodes[mesh.facet_nodes[is_pile, :2]]
    places = np.array([0.5 - 0.5 / np.sqrt(3.0), 0.5 + 0.5 / np.sqrt(3.0)])
    positions = ends[:, :1] + places[:, None] * (ends[:, 1:] - ends[:, :1])
    lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    parts = np.repeat(mesh.facet_tag[is_pile], 2)
    return SimpleNamespace(
        positions=positions.reshape(-1, 2),
        areas=np.repeat(0.5 * lengths, 2),
        normals=surface_normals(parts),
        parts=parts,
    )


@pytest.fixture(scope="session")
def build() -> SimpleNamespace:
    """The functions above, for tests that vary their arguments."""
    return SimpleNamespace(
        points=scattered_points,
        interface=interface_points,
        installed=installed_state,
        integration_points=integration_points,
        pile_surface=pile_surface,
    )
