"""Programmes of loading as sequences of steps, each of which can be cut into parts."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from service_fe.options import (
    Cycles,
    Displace,
    Lateral,
    Load,
    Programme,
    Release,
    Resume,
    Rotate,
)
from service_fe.rigid_pile import PileControl, axial, head_frame, n_motions

ALONG, ACROSS, UP, TILT_ACROSS, TILT, TWIST = range(6)
"""Components of a motion in space in the frame of the head: translations, then rotations.

``TILT`` is about the horizontal axis at 90 degrees from the direction of the load.
"""

COMPONENT = {"vertical": UP, "lateral": ALONG, "moment": TILT, "torque": TWIST}


EQUILIBRATED, RELEASED, RESUMED = "equilibrated", "released", "resumed"
"""States that programmes start from: as handed over, and at the end of the last programme of kind
"release" or "resume".
"""

END_OF = {Release.kind: RELEASED, Resume.kind: RESUMED}
"""Names of the states in which programmes of these kinds end; both start as handed over."""


def start_of(programme: Programme) -> str:
    """Return the name of the state that a programme starts from."""
    return EQUILIBRATED if isinstance(programme, Release | Resume) else programme.start


def contradiction(programmes: Sequence[Programme]) -> str | None:
    """Return what is wrong with names, ways and starts of ``programmes``, None if nothing is."""
    counts = Counter(programme.name for programme in programmes)
    for name, count in counts.items():
        if count > 1:
            return f"{count} programmes are named {name!r}; give each a name of its own"
    known: set[str] = set()
    for programme in programmes:
        if _way(programme) == 0.0:
            return f"{programme.name!r} has no displacement; give it one"
        wrong = _wrong_start(programme.name, start_of(programme), known)
        if wrong is not None:
            return wrong
        known |= {programme.name, END_OF.get(programme.kind, programme.name)}
    return None


def _way(programme: Programme) -> float | None:
    """Return how far a programme that prescribes it moves or turns the pile, in m or rad."""
    if isinstance(programme, Rotate):
        return programme.rotation
    return programme.displacement if isinstance(programme, Displace | Lateral) else None


def _wrong_start(name: str, start: str, known: set[str]) -> str | None:
    """Return what is wrong with the start of a programme, None if nothing is."""
    if start == EQUILIBRATED or start in known:
        return None
    for kind, end in END_OF.items():
        if start == end:
            return (
                f"{name!r} starts from the {end} pile; put a programme of kind "
                f'"{kind}" before it, or set start = "equilibrated"'
            )
    before = ", ".join(sorted({EQUILIBRATED, *known}))
    return f"{name!r} starts from {start!r}, which is not before it; use one of {before}"


class Mode(NamedTuple):
    """Which motions of the pile are prescribed, and what the curve of a programme shows."""

    frame: np.ndarray
    """F (n_motions, n_motions) of ``rigid_pile``."""
    is_loaded: np.ndarray
    """(n_motions,) bool."""
    measure: np.ndarray
    """Unit vector (n_motions,): displacement and load of the curve are the components along it."""


@dataclass(frozen=True, eq=False)
class ImposedStep:
    """One step of a programme; ``control`` gives any part of it."""

    mode: Mode
    motion: np.ndarray
    """Increment (n_motions,) of the prescribed motions in the whole step, in m and rad."""
    load_start: np.ndarray
    """Loads (n_motions,) on the modelled part at the start of the step, in N and N m."""
    load_end: np.ndarray

    @property
    def size(self) -> float:
        """Displacement or change of load of the whole step, as the curve shows it."""
        change = self.load_end - self.load_start if self.is_driven_by_load else self.motion
        return float(self.mode.measure @ change)

    @property
    def is_driven_by_load(self) -> bool:
        """Whether the motion that the curve shows is unknown."""
        return bool(self.mode.is_loaded[self.mode.measure != 0.0].any())

    def control(self, start: float, end: float) -> PileControl:
        """Return what is imposed on the pile from share ``start`` to share ``end`` of the step."""
        load = self.load_start + end * (self.load_end - self.load_start)
        return PileControl(self.mode.is_loaded, (end - start) * self.motion, load, self.mode.frame)


def mode_of(programme: Programme, dim: int) -> Mode:
    """Return what a programme prescribes, and what its curve shows."""
    size = n_motions(dim)
    is_loaded, measure, frame = np.zeros(size, dtype=bool), -axial(dim), np.eye(size)
    if isinstance(programme, Release):
        is_loaded = axial(dim) > 0.0 if dim == 2 else ~is_loaded
    elif isinstance(programme, Lateral):
        frame, measure = head_frame(programme.height, programme.direction), np.eye(6)[ALONG]
        kept = [ALONG] if programme.head == "free" else [ALONG, TILT_ACROSS, TILT, TWIST]
        is_loaded = ~np.isin(np.arange(6), kept)
    elif isinstance(programme, Rotate) and programme.about == "axis":
        measure = np.eye(6)[TWIST]
        is_loaded[UP] = programme.advance is None
    elif isinstance(programme, Rotate):
        frame, measure = head_frame(0.0, programme.direction), np.eye(6)[TILT]
        is_loaded = np.arange(6) != TILT
    elif isinstance(programme, Load | Cycles):
        frame, is_loaded = head_frame(programme.height, programme.direction), ~is_loaded
        measure = _unit(_leading(programme))
    return Mode(frame, is_loaded, measure)


def shows_moment(programme: Programme) -> bool:
    """Return whether the curve of a programme shows a rotation and its moment or torque."""
    return bool(mode_of(programme, 3).measure[TILT_ACROSS:].any())


def _leading(programme: Load | Cycles) -> str:
    """Return the component that the curve of a programme driven by loads shows."""
    if isinstance(programme, Cycles):
        return programme.component
    given = [name for name in ("lateral", "moment", "torque") if getattr(programme, name)]
    return given[0] if given else "vertical"


def _unit(component: str) -> np.ndarray:
    """Return the unit vector (6,) of a component; the vertical one is positive downward."""
    unit = np.zeros(6)
    unit[COMPONENT[component]] = -1.0 if component == "vertical" else 1.0
    return unit


def imposed_steps(
    programme: Programme, load: np.ndarray, rebound: np.ndarray | None = None
) -> list[ImposedStep]:
    """Return the steps of a programme that starts at ``load`` (n_motions,) in N and N m.

    The load is that of the reference point on the modelled part of the pile.  ``rebound``
    (n_motions,) in m and rad is the motion of the pile while the rig let go; None: it did not.
    """
    dim = 2 if len(load) == n_motions(2) else 3
    mode = mode_of(programme, dim)
    start = load @ mode.frame
    if isinstance(programme, Release):
        shares = np.linspace(1.0, 0.0, programme.steps + 1)
        return _load_steps(mode, [share * start for share in shares])
    if isinstance(programme, Resume):
        return _way_back(programme, mode, start, rebound)
    if isinstance(programme, Load):
        end = sum(getattr(programme, name) * _unit(name) for name in COMPONENT)
        return _load_steps(mode, list(np.linspace(start, end, programme.steps + 1)))
    if isinstance(programme, Cycles):
        return _load_steps(mode, _cyclic_loads(programme, start, mode.measure))
    if isinstance(programme, Rotate):
        motion = programme.rotation * mode.measure
        motion[UP] = -(programme.advance or 0.0)
        return _motion_steps(mode, motion, abs(programme.rotation), programme, start)
    motion = programme.displacement * mode.measure
    return _motion_steps(mode, motion, abs(programme.displacement), programme, start)


def _way_back(
    programme: Resume, mode: Mode, load: np.ndarray, rebound: np.ndarray | None
) -> list[ImposedStep]:
    """Return the steps in which the pile, free of force and torque, undoes its ``rebound``."""
    if rebound is None or not rebound.any():
        return [ImposedStep(mode, np.zeros(len(load)), load, load)]
    is_let_go = np.isin(np.arange(len(load)), [UP, TWIST])
    free = np.where(is_let_go, 0.0, load)
    let_go = ImposedStep(mode._replace(is_loaded=is_let_go), np.zeros(len(load)), load, free)
    back = ImposedStep(mode, -rebound / programme.steps, free, free)
    return [let_go, *[back] * programme.steps]


def _load_steps(mode: Mode, loads: list[np.ndarray]) -> list[ImposedStep]:
    """Return the steps from each of the loads (n_motions,) to the next."""
    return [ImposedStep(mode, np.zeros(len(end)), start, end) for start, end in pairwise(loads)]


def _cyclic_loads(programme: Cycles, start: np.ndarray, measure: np.ndarray) -> list[np.ndarray]:
    """Return the loads (n_motions,) at the ends of all steps; each cycle ends at the mean."""
    rest = start - (start @ measure) * measure
    mean = rest + programme.mean * measure
    first = np.linspace(start, mean, 2) if abs((mean - start) @ measure) > 0.0 else mean[None]
    quarter = np.arange(1, programme.steps + 1) / programme.steps
    wave = np.concatenate([quarter, 1.0 - quarter, -quarter, quarter - 1.0])
    cyclic = [mean + programme.amplitude * share * measure for share in wave]
    return [*first, *(cyclic * programme.cycles)]


def _motion_steps(
    mode: Mode,
    motion: np.ndarray,
    length: float,
    programme: Displace | Lateral | Rotate,
    load: np.ndarray,
) -> list[ImposedStep]:
    """Return equal steps, the first in parts that double, because the start of a curve is stiff."""
    n_steps = max(1, int(np.ceil(length / programme.step - 1e-9)))
    parts = 0.5 ** np.arange(programme.first_step_halvings, 0, -1)
    first = [*parts[:1], *parts] if len(parts) else [1.0]
    step = motion / n_steps
    return [
        ImposedStep(mode, share * step, load, load) for share in [*first, *[1.0] * (n_steps - 1)]
    ]
