"""Whether a hand-over keeps the limits of its certificate; what is said and done if it does not.

Without ``--accept-uncertified`` the service stage does not begin from ground whose certificate has
failed: its curves would be taken for those of the installed pile.
"""

from __future__ import annotations

import json
from html import escape
from pathlib import Path
from typing import Any

from workflows.case import AnyCase
from workflows.directory import HANDED_OFF
from workflows.errors import DirectoryError
from workflows.state_files import read_checked

ACCEPT = "--accept-uncertified"
"""Option of the commands that load the installed pile."""

Rows = dict[str, dict[str, Any]]
"""Certificate as plain data: value, unit, meaning, limit and is_met of each figure by name."""


def failed_rows(certificate: Rows) -> list[str]:
    """Return the names of the figures that do not keep their limits."""
    return [name for name, figure in certificate.items() if not figure["is_met"]]


def check_certified(directory: Path, case: AnyCase, *, accept: bool) -> list[str]:
    """Check the hand-over in ``directory``; return a remark if it has failed and is accepted.

    The certificate is the one inside ``handed_off.h5``, which its seal protects.

    Raises
    ------
    StateFileError, DirectoryError
        If the file is missing or damaged, or belongs to another case; if the certificate has failed
        and is not accepted, naming the rows.
    """
    certificate: Rows = json.loads(read_checked(directory, HANDED_OFF, case).certificate)
    failed = failed_rows(certificate)
    if not failed:
        return []
    rows = ", ".join(_beside_limit(name, certificate[name]) for name in failed)
    if accept:
        return [f"the hand-over is not certified, and accepted: {rows}"]
    raise DirectoryError(
        f"{directory / HANDED_OFF}: the hand-over is not certified: {rows}; refine the case, or go"
        f" on with {ACCEPT}"
    )


def warning_html(certificate: Rows) -> str:
    """Return, in red, what a reader must know before the results in service; mostly nothing."""
    failed = failed_rows(certificate)
    if not failed:
        return ""
    rows = ", ".join(f"<code>{escape(name)}</code>" for name in failed)
    return (
        '<p class="warning"><strong class="fail">Not certified.</strong> Checks of the certificate'
        f" that failed: {len(failed)} ({rows}). The pile was loaded all the same, with"
        f' <code>{ACCEPT}</code>. Look at <a href="#handoff">Hand-over</a> before using the'
        " results in service.</p>"
    )


def _beside_limit(name: str, figure: dict[str, Any]) -> str:
    return f"{name} is {figure['value']:.3g} (limit {figure['limit']:.3g})"
