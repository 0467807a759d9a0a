"""Loads small piles in space on as many ranks as there are; the first writes the result.

mpirun -n N python -m tests.service_fe.on_ranks FILE
"""

import sys
from pathlib import Path

import numpy as np
from mpi4py import MPI

from install_mpm.constitutive.parameters import CoulombInterface, VonMises
from install_mpm.conventions import Kinematics
from install_mpm.ground import Ground
from service_fe.options import Lateral, Release
from service_fe.problem import ServiceProblem
from service_fe.solve import run
from tests.service_fe import test_deformable_pile
from tests.service_fe.test_three_dimensions import square_normals, square_pile_mesh

CLAY = VonMises(youngs_modulus=4e6, poissons_ratio=0.45, undrained_shear_strength=20e3)
ROUGH = CoulombInterface(normal_stiffness=2e8, shear_stiffness=2e7, adhesion_factor=0.5)
PROGRAMMES = (
    Release(steps=1),
    Lateral("lateral", 0.02, 0.02, height=1.0, direction=0.3, first_step_halvings=0),
)


STEEL_PUSH = (
    Lateral("steel", 4e-3, 2e-3, height=0.5, start="equilibrated", first_step_halvings=0),
)


def rigid_and_deformable():
    """Return a rigid pile and one of steel between twins, with start and programmes."""
    rigid = ServiceProblem(
        square_pile_mesh(), Ground(18e3, 0.8, CLAY), ROUGH, 1e3,
        kinematics=Kinematics.THREE_D, normals=square_normals,
    )  # fmt: skip
    meshes = test_deformable_pile.square_meshes()
    steel = test_deformable_pile.model_of(meshes, 200e9)
    around = ServiceProblem(
        meshes[0], test_deformable_pile.GROUND, ROUGH,
        kinematics=Kinematics.THREE_D, normals=test_deformable_pile.square_normals,
    )  # fmt: skip
    return (
        (rigid, rigid.wished_in_place_state(), PROGRAMMES),
        (steel.problem, steel.start(around.wished_in_place_state()), STEEL_PUSH),
    )


def main() -> None:
    """Run the programmes and write curves, stress, displacement and what the pile feels."""
    models = rigid_and_deformable()
    n_own = MPI.COMM_WORLD.allgather(len(models[0][0].own_points))
    entries = [entry for model in models for entry in run(*model).programmes]
    if MPI.COMM_WORLD.rank > 0:
        return
    arrays = {"own_points": np.array(n_own)}
    for entry in entries:
        name = entry.programme.name
        arrays[f"{name}_load"], arrays[f"{name}_motion"] = entry.curve.load, entry.curve.motion
        arrays[f"{name}_stress"] = entry.state.cauchy_stress
        arrays[f"{name}_displacement"] = entry.soil.displacement
        for field, values in entry.along._asdict().items():
            arrays[f"{name}_along_{field}"] = values
    np.savez(Path(sys.argv[1]), **arrays)


if __name__ == "__main__":
    main()
