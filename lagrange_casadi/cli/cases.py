"""``lagrange-casadi cases`` and ``new``: the cases that come with the package, and a case of one's
own, begun as one of these or as a model of another program.
"""

from __future__ import annotations

import ast
import os
import re
import shlex
from collections.abc import Mapping, Sequence
from pathlib import Path

from ..base.folders import filling
from ..base.shipped_cases import shipped_cases
from ..errors import PathError, check_known
from .echo import echo
from .options import refuse


def cases(
    *,
    copy: Path | None = None,
) -> None:
    """List the cases that come with the package, or copy them.

    The name of each is a CASE for the other commands, as in run four_bar.

    Parameters
    ----------
    copy : FOLDER
        Copy all of them into this new folder.
    """
    found = shipped_cases()
    if not found:
        raise PathError("the cases were not installed with the package: they are in its repository")
    if copy is None:
        echo(*(f"{name:18} {_sentence(folder / 'case.py')}" for name, folder in found.items()))
        return
    _put(
        {
            f"{name}/{file}": content
            for name, folder in found.items()
            for file, content in _files(folder).items()
        },
        copy,
    )
    echo(
        f"copied {len(found)} cases: begin with lagrange-casadi run"
        f" {shlex.quote(str(copy / next(iter(found))))}"
    )


def _sentence(file: Path) -> str:
    """The first line of what a case says of itself."""
    return (ast.get_docstring(ast.parse(file.read_text(encoding="utf-8"))) or "").partition("\n")[0]


def _files(folder: Path) -> dict[str, bytes]:
    """The files of a case by their names, but for compiled modules."""
    return {
        file.relative_to(folder).as_posix(): file.read_bytes()
        for file in sorted(folder.rglob("*"))
        if file.is_file() and "__pycache__" not in file.parts
    }


def _put(files: Mapping[str, bytes], folder: Path) -> None:
    """Write files into a new folder. Raises :class:`PathError` if it is there."""
    if os.path.lexists(folder):
        raise PathError(f"{folder} exists: expected a new folder")
    with filling(folder) as draft:
        for name, content in files.items():
            place = draft / name
            place.parent.mkdir(parents=True, exist_ok=True)
            place.write_bytes(content)


def new(
    folder: Path,
    *,
    like: str | None = None,
    source: Path | None = None,
    accept_inertias: bool = False,
    payload: Sequence[str] = (),
    floating: str | None = None,
    posture: Mapping[str, float] | None = None,
    contacts: Sequence[str] | None = None,
) -> None:
    """Begin a case of your own in a new FOLDER.

    It is a copy of one that comes with the package, under the folder's name, or a script or a model
    of another program that is written as a case.

    Parameters
    ----------
    folder : FOLDER
    like : NAME
        Copy this case; the command cases lists all.
    source : FILE
        Begin with a script that makes a Scene, .py, or a model of another program: .json, .asmt,
        .urdf, .sdf or .xml (MuJoCo).
    accept_inertias
        Take moments of inertia that no body has as FILE gives them.
    payload : FRAME=MASS[@(X,Y,Z)]
        Put a mass at a link or frame of FILE, at a place on its axes: tool0=3kg@(0,0,0.1).
    floating : [LINK]
        Let the base of the robot move freely, with its mass, or another link or frame in its place.
    posture : NAME=VALUE
        Let a coordinate have this value at the start.
    contacts : NAME,...
        Let the origins of these links or frames stay on the ground, where the posture puts them.
    """
    model = source is not None and source.suffix != ".py"
    refuse(
        (like is not None and source, "--like and --from exclude each other"),
        (accept_inertias and not model, "--accept-inertias needs --from FILE of a model"),
        (payload and not model, "--payload needs --from FILE of a model"),
        (floating is not None and not model, "--floating needs --from FILE of a model"),
        (posture and not model, "--posture needs --from FILE of a model"),
        (contacts and not model, "--contacts needs --from FILE of a model"),
    )
    if source is None:
        files, notes = _copied("four_bar" if like is None else like, folder), list[str]()
    elif not model:
        from ..studies.script import case_of_script

        text, left = case_of_script(source)
        files = {"case.py": text.encode()}
        said = f"left out, as it prints or follows the scene: lines {', '.join(left)}"
        notes = [said] if left else []
    else:
        from ..interop.formats import case_of

        text = case_of(
            source,
            accept_inertias=accept_inertias,
            payload=payload,
            floating=floating or floating is not None,
            posture=posture,
            contacts=contacts or (),
        )
        files = {"case.py": text.encode()}
        notes = [line[2:] for line in text.splitlines() if line.startswith("# ")]
    _put(files, folder)
    echo(*notes)
    echo(
        f"wrote {folder / 'case.py'}: {'change' if source is None else 'read'} it, then"
        f" lagrange-casadi run {shlex.quote(str(folder))}"
    )


def _copied(like: str, folder: Path) -> dict[str, bytes]:
    """The files of a case by their names, of one that comes with the package: its mechanism is
    named after the folder, as far as that is a name.
    """
    found = shipped_cases()
    check_known("case", [like], found)
    files = _files(found[like])
    files.pop("README.md", None)  # which says what the other one is
    name = re.sub(r"[^A-Za-z0-9_]", "_", Path(os.path.abspath(folder)).name)
    if name[:1].isalpha():
        declared, renamed = (f'Mechanism("{one}")'.encode() for one in (like, name))
        files["case.py"] = files["case.py"].replace(declared, renamed)
    return files
