"""Drucker-Prager of OpenSees in a drained triaxial test: another code as the reference.

Needs the package openseespy (extra ``opensees``).  It brings libraries of its own that do not bear
those of PETSc beside them, so it runs in a process of its own, which is this file as a program.
"""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import asdict
from importlib import import_module
from typing import Any

import numpy as np

from install_mpm.constitutive.parameters import DruckerPrager

PACKAGE = "openseespy"
CORNERS = [(x, y, z) for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
"""Nodes of the brick, of unit size."""
UNIFORM = 1e-6
"""Largest difference of stress between the Gauss points of the brick over the cell pressure."""


def drained_triaxial(
    soil: DruckerPrager, cell_pressure: float, shortening: float, steps: int
) -> tuple[np.ndarray, np.ndarray]:
    """Return deviator stress q in Pa and volumetric strain, (steps,) each.

    One brick between three rollers takes the cell pressure, and is then shortened in equal
    ``steps``; the volumetric strain begins at the end of the cell pressure.

    Raises
    ------
    RuntimeError
        If OpenSees does not converge, or its brick does not stay uniform.
    """
    inputs = [asdict(soil), cell_pressure, shortening, steps]
    done = subprocess.run(
        [sys.executable, "-m", __name__], input=json.dumps(inputs), capture_output=True, text=True,
        check=False,
    )  # fmt: skip
    if done.returncode:
        raise RuntimeError(f"OpenSees failed: {done.stderr.strip().splitlines()[-1:]}")
    q, volume = np.array(json.loads(done.stdout.splitlines()[0])).T
    return q[1:], volume[1:] - volume[0]


def _triaxial_rows(
    soil: DruckerPrager, cell_pressure: float, shortening: float, steps: int
) -> list[tuple[float, float]]:
    """Return q in Pa and the volumetric strain at the cell pressure and after every step."""
    ops = import_module("openseespy.opensees")
    _make_brick(ops, soil)
    _load_brick(ops, soil, cell_pressure, shortening)
    ops.constraints("Transformation")
    ops.numberer("Plain")
    ops.system("FullGeneral")
    ops.test("NormDispIncr", 1e-12, 50)
    ops.algorithm("Newton")
    rows = []
    for time_step, count in ((1.0, 1), (1.0 / steps, steps)):
        ops.integrator("LoadControl", time_step)
        ops.analysis("Static")
        rows += [_advance(ops, cell_pressure) for _ in range(count)]
    return rows


def _advance(ops: Any, cell_pressure: float) -> tuple[float, float]:
    """Return q in Pa and the volumetric strain after one step more."""
    if ops.analyze(1) != 0:
        raise RuntimeError("OpenSees does not converge in the triaxial test")
    stress = np.array(ops.eleResponse(1, "stresses")).reshape(8, 6)
    if np.ptp(stress, axis=0).max() > UNIFORM * cell_pressure:
        raise RuntimeError("the stress in the brick of OpenSees is not uniform")
    return stress[0, 0] - stress[0, 2], sum(ops.nodeDisp(7, axis) for axis in (1, 2, 3))


def _moduli(soil: DruckerPrager) -> tuple[float, float]:
    """Return bulk and shear modulus in Pa."""
    return (
        soil.youngs_modulus / (3.0 * (1.0 - 2.0 * soil.poissons_ratio)),
        soil.youngs_modulus / (2.0 * (1.0 + soil.poissons_ratio)),
    )


def _make_brick(ops: Any, soil: DruckerPrager) -> None:
    """Make one brick of OpenSees' law, |s| + rho I_1 <= sqrt(2/3) sigma_Y, on three rollers."""
    ops.wipe()
    ops.model("basic", "-ndm", 3, "-ndf", 3)
    for tag, corner in enumerate(CORNERS, 1):
        ops.node(tag, *map(float, corner))
        ops.fix(tag, *(int(component == 0) for component in corner))
    rho, rho_bar = (
        2.0 * np.sqrt(2.0) * np.sin(angle) / (np.sqrt(3.0) * (3.0 - np.sin(angle)))
        for angle in (soil.friction_angle, soil.dilation_angle)
    )
    sine, cosine = np.sin(soil.friction_angle), np.cos(soil.friction_angle)
    strength = 6.0 * soil.cohesion * cosine / (3.0 - sine)
    no_hardening = [0.0] * 7
    ops.nDMaterial("DruckerPrager", 1, *_moduli(soil), strength, rho, rho_bar, *no_hardening)
    ops.element("stdBrick", 1, *range(1, 9), 1)


def _load_brick(ops: Any, soil: DruckerPrager, cell_pressure: float, shortening: float) -> None:
    """Apply the cell pressure until time 1, then the shortening, complete at time 2."""
    pressed = -cell_pressure / (3.0 * _moduli(soil)[0])
    times = ("-time", 0.0, 1.0, 3.0, "-values")
    ops.timeSeries("Path", 1, *times, 0.0, 1.0, 1.0)
    ops.timeSeries("Path", 2, *times, 0.0, pressed, pressed - 2.0 * shortening)
    ops.pattern("Plain", 1, 1)
    for tag, (x, y, _) in enumerate(CORNERS, 1):
        ops.load(tag, -0.25 * cell_pressure * x, -0.25 * cell_pressure * y, 0.0)
    ops.pattern("Plain", 2, 2)
    for tag, (_, _, z) in enumerate(CORNERS, 1):
        if z:
            ops.sp(tag, 3, 1.0)


if __name__ == "__main__":
    law, *test = json.load(sys.stdin)
    print(json.dumps(_triaxial_rows(DruckerPrager(**law), *test)), flush=True)
