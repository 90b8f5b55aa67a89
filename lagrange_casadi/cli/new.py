"""``lagrange-casadi new``: a case of one's own, begun as one that comes with the package, or as a
model of another program.
"""

from __future__ import annotations

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


def new(folder: Path, like: str | None, source: Path | None) -> None:
    """See :func:`.commands.new`."""
    if source is not None:
        if like is not None:
            raise DeclarationError("--like and --from exclude each other")
        _translated(folder, source)
        return
    like, found = like or SIMPLE, shipped_cases()
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
