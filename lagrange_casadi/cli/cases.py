"""``lagrange-casadi cases`` and ``new``: the cases that come with the package, and a case of one's
own, begun as one of these or as a model of another program.
"""

from __future__ import annotations

import ast
import os
import re
import shlex
import shutil
from pathlib import Path

from ..base.publish import filling
from ..base.vocabulary import SIMPLE
from ..errors import DeclarationError, PathError, UnknownNameError
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


def new(folder: Path, like: str | None, source: Path | None) -> None:
    """See :func:`.commands.new`."""
    if source is not None:
        if like is not None:
            raise DeclarationError("--like and --from exclude each other")
        _translated(folder, source)
        return
    like, found = SIMPLE if like is None else like, shipped_cases()
    if like not in found:
        raise UnknownNameError("case", like, found)
    if os.path.lexists(folder):
        raise PathError(f"{folder} exists: expected a new folder")
    with filling(folder) as draft:
        for file in sorted(found[like].iterdir()):
            if file.is_file() and file.name != "README.md":  # which says what the other one is
                shutil.copyfile(file, draft / file.name)
        case = draft / "case.py"
        case.write_text(
            _renamed(case.read_text(encoding="utf-8"), like, folder), encoding="utf-8", newline="\n"
        )
    echo(
        f"wrote {folder / 'case.py'}: change it, then lagrange-casadi run"
        f" {shlex.quote(str(folder))}"
    )


def _translated(folder: Path, source: Path) -> None:
    """Write the case of a model of another program."""
    from ..formats import case_of

    text = case_of(source)
    if os.path.lexists(folder):
        raise PathError(f"{folder} exists: expected a new folder")
    with filling(folder) as draft:
        (draft / "case.py").write_text(text, encoding="utf-8", newline="\n")
    for line in text.splitlines():
        if line.startswith("# "):
            echo(line[2:])
    echo(
        f"wrote {folder / 'case.py'}: read it, then lagrange-casadi run {shlex.quote(str(folder))}"
    )


def _renamed(text: str, like: str, folder: Path) -> str:
    """A case's text, its mechanism under the folder's name, as far as that is a name."""
    name = re.sub(r"[^A-Za-z0-9_]", "_", Path(os.path.abspath(folder)).name)
    return (
        text.replace(f'Mechanism("{like}")', f'Mechanism("{name}")') if name[:1].isalpha() else text
    )
