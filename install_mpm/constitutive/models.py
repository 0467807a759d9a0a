"""Soil laws by number: parameters, compiled module and id of each."""

from __future__ import annotations

from enum import IntEnum

from install_mpm.constitutive import (
    critical_state_sand,
    drucker_prager,
    elastic,
    modified_cam_clay,
    mohr_coulomb,
    neo_hookean,
    tresca,
    von_mises,
)
from install_mpm.constitutive.parameters import (
    CriticalStateSand,
    DruckerPrager,
    HenckyElastic,
    ModifiedCamClay,
    MohrCoulomb,
    NeoHookean,
    Tresca,
    VonMises,
)


class Model(IntEnum):
    """Soil laws; the number is what kernels and files carry."""

    HENCKY_ELASTIC = 0
    VON_MISES = 1
    NEO_HOOKEAN = 2
    TRESCA = 3
    MOHR_COULOMB = 4
    DRUCKER_PRAGER = 5
    MODIFIED_CAM_CLAY = 6
    CRITICAL_STATE_SAND = 7


MODEL_OF = {
    HenckyElastic: Model.HENCKY_ELASTIC,
    VonMises: Model.VON_MISES,
    NeoHookean: Model.NEO_HOOKEAN,
    Tresca: Model.TRESCA,
    MohrCoulomb: Model.MOHR_COULOMB,
    DruckerPrager: Model.DRUCKER_PRAGER,
    ModifiedCamClay: Model.MODIFIED_CAM_CLAY,
    CriticalStateSand: Model.CRITICAL_STATE_SAND,
}
MODULE_OF = {
    Model.HENCKY_ELASTIC: elastic,
    Model.VON_MISES: von_mises,
    Model.NEO_HOOKEAN: neo_hookean,
    Model.TRESCA: tresca,
    Model.MOHR_COULOMB: mohr_coulomb,
    Model.DRUCKER_PRAGER: drucker_prager,
    Model.MODIFIED_CAM_CLAY: modified_cam_clay,
    Model.CRITICAL_STATE_SAND: critical_state_sand,
}
