"""Kill an installation at random moments and resume it: the harness of test_resume.py.

Also a script: ``python tests/workflows/interrupted.py CASE KILLS`` prints what happened.
"""

import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import h5py
import numpy as np


def start_install(case, directory, *options):
    """Start ``screwpile install`` in a process group of its own."""
    command = [sys.executable, "-m", "workflows.cli", "install", str(case), "-o", str(directory)]
    return subprocess.Popen(
        [*command, *options],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        start_new_session=True,
    )


def wait_for(process):
    """Wait for success; return the seconds it took."""
    start = time.perf_counter()
    _, errors = process.communicate(timeout=600)
    assert process.returncode == 0, errors.decode()
    return time.perf_counter() - start


def kill_after(process, seconds):
    """Send SIGKILL after ``seconds``; return whether the process was still running then."""
    try:
        process.communicate(timeout=seconds)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.communicate()
        return True
    return False


def install_with_kills(case, directory, kills, duration, random_source):
    """Start an installation, kill it ``kills`` times at random moments, then let it finish.

    Returns the moments of the kills in s; ``duration`` is that of an uninterrupted run.  A run that
    ends before it is killed is followed by one from the beginning.
    """
    moments = []
    options = ()
    while len(moments) < kills:
        moment = random_source.uniform(0.2, 0.9) * duration
        if kill_after(start_install(case, directory, *options), moment):
            moments.append(moment)
        options = ("--resume",)
    wait_for(start_install(case, directory, *options))
    return moments


def differences(first, second):
    """Return the names of datasets and attributes that are not bit-equal in two HDF5 files."""
    different = []

    def contents(file):
        found = {f"/@{name}": value for name, value in file.attrs.items()}

        def collect(name, item):
            if isinstance(item, h5py.Dataset):
                found[name] = item[()]
            found.update({f"{name}@{key}": value for key, value in item.attrs.items()})

        file.visititems(collect)
        return found

    with h5py.File(first) as one, h5py.File(second) as other:
        left, right = contents(one), contents(other)
    for name in sorted(left.keys() | right.keys()):
        is_shared = name in left and name in right
        if not is_shared or np.asarray(left[name]).tobytes() != np.asarray(right[name]).tobytes():
            different.append(name)
    return different


def main(case, kills):
    """Compare an uninterrupted installation with one that is killed ``kills`` times."""
    with tempfile.TemporaryDirectory() as folder:
        whole, broken = Path(folder) / "whole", Path(folder) / "broken"
        wait_for(start_install(case, whole))  # compiles
        duration = wait_for(start_install(case, whole))
        print(f"uninterrupted: {duration:.1f} s")
        moments = install_with_kills(case, broken, kills, duration, random.Random())
        print("killed after", ", ".join(f"{moment:.1f} s" for moment in moments))
        found = differences(whole / "installed.h5", broken / "installed.h5")
    print(f"datasets that differ: {found or 'none'}")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), int(sys.argv[2])))
