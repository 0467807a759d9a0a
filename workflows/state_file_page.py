"""The page on the state files, made from the definitions of their records.

python -m workflows.state_file_page > docs/state_file.md
"""

from __future__ import annotations

import sys
from pathlib import Path
from string import Template
from types import ModuleType

from handoff import fe_state_file
from install_mpm import state_file
from install_mpm.constitutive.dispatch import MODULE_OF
from install_mpm.constitutive.state_variables import STATE_VARIABLES
from install_mpm.conventions import CONVENTIONS
from install_mpm.record import describe
from service_fe import result_file

TEMPLATE = Path(__file__).parent / "templates" / "state_file.md"


def state_file_page() -> str:
    """Return the page as Markdown."""
    programmes = {
        f"programmes/<number>/{group}": record
        for group, record in (*result_file.PROGRAMME_RECORDS.items(), *result_file.ALONG.items())
    }
    return Template(TEMPLATE.read_text(encoding="utf-8")).substitute(
        conventions="\n".join(f"- {convention}" for convention in CONVENTIONS),
        state_variables=_state_variables(),
        installed_format=_format_of(state_file),
        installed=describe(state_file.RECORDS),
        handed_off_format=_format_of(fe_state_file),
        handed_off=describe(fe_state_file.RECORDS),
        service_format=_format_of(result_file),
        service=describe({**result_file.RECORDS, **programmes}),
    )


def _state_variables() -> str:
    """Return the names of each soil law in order, and unit and meaning of every name."""
    lines = []
    for model in MODULE_OF:
        names = (f"`{name}`" for name in MODULE_OF[model].STATE_VARIABLES)
        lines.append(f"- `{model.name.lower()}`: {', '.join(names) or 'none'}")
    lines += ["", "| state variable | unit | meaning |", "|---|---|---|"]
    for name, variable in STATE_VARIABLES.items():
        lines.append(f"| `{name}` | {variable.unit or '-'} | {variable.doc} |")
    return "\n".join(lines)


def _format_of(module: ModuleType) -> str:
    return f"Format `{module.FORMAT}`, version {module.VERSION}"


if __name__ == "__main__":
    sys.stdout.write(state_file_page())
