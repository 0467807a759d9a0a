"""Where the time of a run goes: wall seconds by phase of the method, added up in this process."""

from __future__ import annotations

import time
from collections import defaultdict
from collections.abc import Iterator
from contextlib import contextmanager

_seconds: defaultdict[str, float] = defaultdict(float)


@contextmanager
def measured(phase: str) -> Iterator[None]:
    """Add the wall time of the block to ``phase``."""
    start = time.perf_counter()
    try:
        yield
    finally:
        _seconds[phase] += time.perf_counter() - start


def start_measuring() -> None:
    """Forget what was measured before."""
    _seconds.clear()


def measured_seconds() -> dict[str, float]:
    """Return the seconds by phase since ``start_measuring``, longest first."""
    return dict(sorted(_seconds.items(), key=lambda item: -item[1]))
