"""Stage 1: jack or screw the pile into the ground.

    python -m workflows.stages.install CASE -o DIR

Reads the case; writes ``installed.h5`` and, while it runs, ``installed.checkpoint.h5``; for a screw
pile also frames in ``paraview/``.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from install_mpm.history import History
from install_mpm.installation import InstallationProgress, Observer, install
from install_mpm.screw_history import driven
from install_mpm.screw_installation import install_screw_pile
from install_mpm.state_file import InstalledState, write_installed_state
from install_mpm.timing import measured_seconds, start_measuring
from workflows.case import AnyCase, Case, case_text
from workflows.directory import CHECKPOINT, INSTALLED, TIMING, write_text
from workflows.manifest import created_by
from workflows.progress import Advance, no_progress
from workflows.report_units import FORCE_UNIT
from workflows.screw_case import ScrewCase
from workflows.screw_export import frame_interval, frame_writer
from workflows.screw_theory import edge_remark
from workflows.state_files import read_checked


def run(case: AnyCase, directory: Path, advance: Advance = no_progress) -> list[str]:
    """Install the pile of ``case``; return remarks for the user.

    The installation continues from the checkpoint in ``directory`` if there is one.

    Raises
    ------
    StateFileError, DirectoryError
        If the checkpoint is damaged or belongs to another case.
    NotConvergedError
        If a step does not converge; nothing is written but the last checkpoint.
    """
    checkpoint, unit = directory / CHECKPOINT, FORCE_UNIT[case.kinematics]

    def observe(state: InstalledState, progress: InstallationProgress) -> None:
        advance(
            round(1e6 * progress.travel),
            round(1e6 * progress.target),
            f"{progress.penetration:.2f} m, {progress.crowd_force / 1e3:.0f} {unit}",
        )
        if progress.load_step > 0 and progress.load_step % case.numerics.checkpoint_every == 0:
            write_installed_state(checkpoint, state, created_by())

    start = _read_checkpoint(directory, case)
    start_measuring()
    if isinstance(case, ScrewCase):
        installed = _screw_in(case, directory, start, observe)
    else:
        installed = _jack_in(case, start, observe)
    write_installed_state(directory / INSTALLED, installed, created_by())
    checkpoint.unlink(missing_ok=True)
    force = float(installed.history.crowd_force[-1])
    return [
        f"pile tip at {float(installed.pile.tip_depth):g} m, "
        f"crowd force {force / 1e3:.1f} {unit} after {len(installed.history.penetration)} steps",
        _times(directory),
        *(
            _torque(installed)
            if isinstance(case, ScrewCase)
            else _renewals(installed.history, unit)
        ),
    ]


def _jack_in(case: Case, start: InstalledState | None, observe: Observer) -> InstalledState:
    return install(
        case.ground,
        case.pile,
        case.interface,
        case.box,
        case.background_mesh,
        case.installation,
        case.numerics,
        case_text(case),
        kinematics=case.kinematics,
        discretisation=case.discretisation,
        resume_from=start,
        observe=observe,
    )


def _screw_in(
    case: ScrewCase, directory: Path, start: InstalledState | None, observe: Observer
) -> InstalledState:
    """Install the pile; frames for ParaView and for the report are stored on the way."""
    store_frame = frame_writer(directory, frame_interval(case))

    def observe_and_store(state: InstalledState, progress: InstallationProgress) -> None:
        store_frame(state, progress)
        observe(state, progress)

    return install_screw_pile(
        case.ground,
        case.pile,
        case.interface,
        case.box,
        case.background_mesh,
        case.installation,
        case.numerics,
        case_text(case),
        resume_from=start,
        observe=observe_and_store,
    )


def _times(directory: Path) -> str:
    """Write where the time went; return it in one line."""
    seconds = measured_seconds()
    rounded = {phase: round(value, 3) for phase, value in seconds.items()}
    write_text(directory / TIMING, json.dumps(rounded, indent=2) + "\n")
    total = sum(seconds.values()) or 1.0
    shares = ", ".join(f"{phase} {100 * value / total:.0f} %" for phase, value in seconds.items())
    return f"time: {shares} of {total:.0f} s"


def _torque(installed: InstalledState) -> list[str]:
    """Return rotation, torque and crowd force when the rig stopped, in one line."""
    history = driven(installed.history)
    turns = abs(float(history.rotation[-1])) / (2.0 * np.pi)
    torque, force = float(history.torque[-1]), float(history.crowd_force[-1])
    return [
        f"rotation {turns:.3g} turns, torque {torque / 1e3:.2f} kN m, "
        f"crowd force {force / 1e3:.2f} kN when the rig stopped",
        *edge_remark(float(history.edge_torque[-1]), float(history.edge_force[-1])),
    ]


def _renewals(history: History, unit: str) -> list[str]:
    """Return what new meshes have changed, in one line; none if there was none."""
    stress = history.remesh_stress_change[np.isfinite(history.remesh_stress_change)]
    force = history.remesh_force_change[np.isfinite(history.remesh_force_change)]
    if not len(stress):
        return []
    return [
        f"mesh made anew {len(stress)} times: stress changed by at most {100 * stress.max():.2g} %,"
        f" crowd force by at most {np.abs(force).max() / 1e3:.2g} {unit}"
    ]


def _read_checkpoint(directory: Path, case: AnyCase) -> InstalledState | None:
    if not (directory / CHECKPOINT).exists():
        return None
    state: InstalledState = read_checked(directory, CHECKPOINT, case)
    return state._replace(case_text=case_text(case))


if __name__ == "__main__":
    from workflows.cli import install as command
    from workflows.script import run_script

    run_script(command)
