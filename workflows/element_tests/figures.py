"""What an engineer reads off a laboratory test: its curves, and its key figures."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from install_mpm.constitutive import dispatch
from install_mpm.constitutive.element_driver import Element
from install_mpm.constitutive.parameters import SoilParameters
from install_mpm.constitutive.state_variables import STATE_VARIABLES
from workflows.element_tests.paths import LaboratoryTest


class Curves(NamedTuple):
    """One row per step, (n,); stresses effective, compression and contraction positive."""

    axial_strain: np.ndarray
    volumetric_strain: np.ndarray
    shear_strain: np.ndarray
    vertical_stress: np.ndarray
    """In Pa."""
    horizontal_stress: np.ndarray
    """In Pa, the mean of the two."""
    shear_stress: np.ndarray
    """In Pa, on the horizontal plane."""
    pore_pressure: np.ndarray
    """In Pa, in excess of that at the start."""
    mean_pressure: np.ndarray
    """In Pa."""
    deviatoric_stress: np.ndarray
    """q = sqrt(3/2) |s| in Pa."""
    largest_shear: np.ndarray
    """Half the difference of the principal stresses in Pa."""
    mobilised_friction: np.ndarray
    """Angle of friction in rad that the principal stresses need without cohesion."""


class Figure(NamedTuple):
    """A key figure of a test."""

    value: float
    unit: str
    meaning: str


def curves_of(path: list[Element]) -> Curves:
    """Return the curves of a test."""
    stress = np.array([state.stress for state in path])
    gradient = np.array([state.gradient for state in path])
    principal = np.linalg.eigvalsh(stress)
    least, most = -principal[:, 2], -principal[:, 0]
    mean = -np.trace(stress, axis1=1, axis2=2) / 3.0
    deviator = stress + mean[:, None, None] * np.eye(3)
    total = np.maximum(most + least, 1e-300)
    return Curves(
        axial_strain=1.0 - gradient[:, 1, 1],
        volumetric_strain=1.0 - np.linalg.det(gradient),
        shear_strain=gradient[:, 0, 1],
        vertical_stress=-stress[:, 1, 1],
        horizontal_stress=-0.5 * (stress[:, 0, 0] + stress[:, 2, 2]),
        shear_stress=stress[:, 0, 1],
        pore_pressure=np.array([state.pore_pressure for state in path]),
        mean_pressure=mean,
        deviatoric_stress=np.sqrt(1.5 * (deviator**2).sum(axis=(1, 2))),
        largest_shear=0.5 * (most - least),
        mobilised_friction=np.arcsin(np.clip((most - least) / total, 0.0, 1.0)),
    )


def key_figures(test: LaboratoryTest, curves: Curves) -> dict[str, Figure]:
    """Return the key figures of a test by name."""
    if test.is_shear:
        return _shear_figures(test, curves)
    if not test.is_isotropic:
        return _oedometer_figures(curves)
    return _triaxial_figures(test, curves)


def _triaxial_figures(test: LaboratoryTest, curves: Curves) -> dict[str, Figure]:
    q, strain = curves.deviatoric_stress, curves.axial_strain
    peak = int(np.argmax(q))
    figures = {
        "peak_q": Figure(q[peak], "Pa", "largest deviatoric stress"),
        "strain_at_peak": Figure(strain[peak], "", "axial strain there"),
        "q_at_end": Figure(q[-1], "Pa", "deviatoric stress at the end"),
        "E50": Figure(secant_modulus(strain, q), "Pa", "secant modulus at half the peak"),
    }
    if test.is_undrained:
        figures["su"] = Figure(curves.largest_shear[peak], "Pa", "undrained shear strength")
        figures["pore_pressure_at_end"] = Figure(
            curves.pore_pressure[-1], "Pa", "excess pore pressure at the end"
        )
    figures["friction_angle"] = _friction(curves, peak)
    if peak < len(q) - 1:
        figures["friction_angle_at_end"] = _friction(curves, len(q) - 1)
    if not test.is_undrained:
        rate = np.gradient(np.log1p(-curves.volumetric_strain), np.log1p(-strain))
        figures["dilation_angle"] = Figure(
            dilation_angle(float(rate[1:].min())), "rad", "largest angle of dilation"
        )
        figures["volume_at_end"] = Figure(
            curves.volumetric_strain[-1], "", "volumetric strain at the end, contraction positive"
        )
    return figures


def _friction(curves: Curves, row: int) -> Figure:
    where = "at the end" if row == len(curves.axial_strain) - 1 else "at the peak"
    return Figure(curves.mobilised_friction[row], "rad", f"mobilised angle of friction {where}")


def dilation_angle(rate: float) -> float:
    """Return psi in rad from the least d(eps_v)/d(eps_1): sin psi = -r / (2 - r), r < 0 dilates.

    Strains are logarithmic.
    """
    return float(np.arcsin(np.clip(-rate / (2.0 - rate), -1.0, 1.0)))


def secant_modulus(strain: np.ndarray, q: np.ndarray) -> float:
    """Return the secant modulus in Pa at half the rise of q (n,) from its start to its peak."""
    rise = q - q[0]
    half = 0.5 * rise.max()
    if half <= 0.0:
        return 0.0
    row = int(np.argmax(rise >= half))
    share = (half - rise[row - 1]) / (rise[row] - rise[row - 1])
    return float(half / (strain[row - 1] + share * (strain[row] - strain[row - 1])))


def _shear_figures(test: LaboratoryTest, curves: Curves) -> dict[str, Figure]:
    tau, gamma = curves.shear_stress, curves.shear_strain
    peak = int(np.argmax(np.abs(tau)))
    figures = {
        "peak_shear_stress": Figure(tau[peak], "Pa", "largest shear stress"),
        "strain_at_peak": Figure(gamma[peak], "", "shear strain there"),
        "shear_stress_at_end": Figure(tau[-1], "Pa", "shear stress at the end"),
        "initial_shear_modulus": Figure(tau[1] / gamma[1], "Pa", "shear modulus of the first step"),
    }
    if test.is_undrained:
        figures["su"] = Figure(curves.largest_shear[peak], "Pa", "undrained shear strength")
        figures["vertical_stress_at_end"] = Figure(
            curves.vertical_stress[-1], "Pa", "effective vertical stress at the end"
        )
    else:
        rate = np.gradient(-np.log1p(-curves.volumetric_strain), gamma)
        figures["dilation_angle"] = Figure(
            float(np.arctan(max(-rate[1:].min(), 0.0))), "rad", "largest angle of dilation"
        )
    figures["friction_angle"] = _friction(curves, peak)
    return figures


def _oedometer_figures(curves: Curves) -> dict[str, Figure]:
    stress, strain = curves.vertical_stress, curves.axial_strain
    middle = len(strain) // 2
    slope = np.gradient(stress, strain)
    return {
        "vertical_stress_at_end": Figure(stress[-1], "Pa", "vertical stress at the end"),
        "initial_modulus": Figure(slope[0], "Pa", "constrained modulus at the start"),
        "modulus_halfway": Figure(slope[middle], "Pa", "constrained modulus halfway"),
        "modulus_at_end": Figure(slope[-1], "Pa", "constrained modulus at the end"),
        "k0_at_end": Figure(
            curves.horizontal_stress[-1] / stress[-1], "", "horizontal over vertical stress"
        ),
    }


def table_of(soil: SoilParameters, path: list[Element]) -> dict[str, np.ndarray]:
    """Return the columns of the table of a test by their heading, which names the SI unit."""
    curves = curves_of(path)
    stresses = {"vertical_stress", "horizontal_stress", "shear_stress", "pore_pressure",
                "mean_pressure", "deviatoric_stress", "largest_shear"}  # fmt: skip
    columns = {}
    for name, values in curves._asdict().items():
        unit = " (Pa)" if name in stresses else " (rad)" if name == "mobilised_friction" else ""
        columns[name + unit] = values
    state = np.array([step.state_variables for step in path])
    for column, name in enumerate(dispatch.state_variable_names(soil)):
        unit = STATE_VARIABLES[name].unit
        columns[f"{name} ({unit})" if unit else name] = state[:, column]
    return columns
