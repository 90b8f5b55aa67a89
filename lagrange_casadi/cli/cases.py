"""``lagrange-casadi cases``: the cases that come with the package, to look at and to begin with."""

from __future__ import annotations

import ast
import shlex
import shutil
from pathlib import Path

from ..base.publish import filling
from ..errors import PathError
from ..shipped_cases import shipped_cases
from .echo import echo


def cases(copy: Path | None) -> None:
    """See :func:`.commands.cases`."""
    found = shipped_cases()
    if not found:
        raise PathError("the cases were not installed with the package: they are in its repository")
    if copy is None:
        for name, folder in found.items():
            echo(f"{name:18} {_sentence(folder / 'case.py')}")
        return
    if copy.exists():
        raise PathError(f"{copy} exists: expected a new folder")
    with filling(copy) as draft:
        for name, folder in found.items():
            for file in sorted(folder.rglob("*")):
                if file.is_file() and "__pycache__" not in file.parts:
                    place = draft / name / file.relative_to(folder)
                    place.parent.mkdir(parents=True, exist_ok=True)
                    shutil.copyfile(file, place)
    echo(
        f"copied {len(found)} cases: begin with lagrange-casadi run"
        f" {shlex.quote(str(copy / next(iter(found))))}"
    )


def _sentence(file: Path) -> str:
    """The first line of what a case says of itself."""
    return (ast.get_docstring(ast.parse(file.read_text(encoding="utf-8"))) or "").partition("\n")[0]
