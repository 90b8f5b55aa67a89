"""Models of other programs as cases: a file is read into a record, and the record is written as a
case.

A format is a module with ``read(model, text)``, which fills a record; :data:`FORMATS` lists them by
the ending of files.
"""

from __future__ import annotations

import os
import stat
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from ...base.arguments import public
from ...base.files import check_writable, writing
from ...base.units import Number
from ...errors import LagrangeCasadiError, ModelFileError, PathError
from ...model.scene import Scene
from . import asmt, json_model, mjcf, sdf, urdf
from .as_case import CaseText
from .checks import checked
from .missing_drives import drive
from .of_scene import model_of
from .record import Model
from .standing import free, placed

__all__ = ["FORMATS", "case_of", "read", "save_model"]

FORMATS: dict[str, Callable[[Model, str], None]] = {
    ".json": json_model.read,
    ".asmt": asmt.read,
    ".urdf": urdf.read,
    ".sdf": sdf.read,
    ".xml": mjcf.read,
}
"""Readers of files by their ending."""

LARGEST = 64 * 2**20
"""Bytes of a file, at most."""


@public
def read(
    path: str | os.PathLike[str],
    *,
    accept_inertias: bool = False,
    payload: Sequence[str] = (),
    floating: bool | str = False,
    posture: Mapping[str, Number] | None = None,
    contacts: Sequence[str] = (),
) -> Scene:
    """Read a mechanism from a file of another program.

    Parameters
    ----------
    path
        The file; its ending is the format, see the page on models of other programs.
    accept_inertias
        True for moments of inertia as the file gives them, also those that no body has.
    payload
        Masses at links or frames of the file, as ``["tool0=3kg@(0,0,0.1)"]``.
    floating
        True for a base that is free, with its mass, of a robot that is not fixed to the ground; or
        the link or frame of the file that is free in place of that base.
    posture
        Coordinates in which the robot stands [rad or m], by their names in the case; others are
        zero.
    contacts
        Links or frames of the file whose origins stay where they are in that posture.

    Returns
    -------
    Scene
        The scene of the case that the command ``new`` writes from it.

    Raises
    ------
    ModelFileError
        For what the package does not support, with file, line and element.
    """
    name: dict[str, Any] = {"__name__": "lagrange_casadi_case"}
    text = case_of(
        path,
        accept_inertias=accept_inertias,
        payload=payload,
        floating=floating,
        posture=posture,
        contacts=contacts,
    )
    exec(compile(text, f"<{Path(path).name}>", "exec"), name)  # our own text, see as_case
    try:
        scene: Scene = name["scene"]()
    except LagrangeCasadiError as error:
        raise ModelFileError(f"{Path(path).name}: {error}") from None
    return scene


def case_of(
    path: str | os.PathLike[str],
    *,
    accept_inertias: bool = False,
    payload: Sequence[str] = (),
    floating: bool | str = False,
    posture: Mapping[str, Number] | None = None,
    contacts: Sequence[str] = (),
) -> str:
    """Return the text of a case for a file of another program, as of :func:`read`."""
    model = _model(Path(path), bool(floating))
    if floating and model.file.suffix.lower() in (".json", ".asmt"):
        raise model.refuse("", "only a URDF, SDF or MJCF has a base that floating= can free")
    for text in payload:
        model.load(text)
    if isinstance(floating, str):
        free(model, floating)
    model = checked(model, accept_inertias=accept_inertias)
    drive(placed(model, posture or {}, contacts))
    return CaseText(model).text()


@public
def save_model(
    scene: Scene,
    path: str | os.PathLike[str],
    parameters: Mapping[str, float] | None = None,
) -> None:
    """Write a scene's mechanism and motion as JSON, which :func:`read` reads.

    Parameters
    ----------
    scene
        The scene.
    path
        The file.
    parameters
        Values that replace defaults, by name: the model has numbers.

    Raises
    ------
    ModelFileError
        For a file that does not end in ``.json``.
    DeclarationError
        For parts that the format does not have.
    PathError
        If the file cannot be written.
    """
    file = Path(path)
    check_writable(file)
    text = json_model.write(checked(model_of(scene, parameters or {}, file)))
    with writing(file) as draft:
        draft.write(text.encode())


def _model(path: Path, floating: bool) -> Model:
    if (reader := FORMATS.get(path.suffix.lower())) is None:
        if path.suffix.lower() == ".xacro":
            raise ModelFileError(
                f"{path.name}: xacro is a macro language; expand it first: xacro {path.name} >"
                f" {path.stem.removesuffix('.urdf')}.urdf"
            )
        raise ModelFileError(
            f"{path.name}: unknown format '{path.suffix}'; valid: {', '.join(FORMATS)}"
        )
    try:
        found = path.stat()
        if not stat.S_ISREG(found.st_mode):
            raise PathError(f"cannot read {path}: it is not a file")
        if found.st_size > LARGEST:
            raise ModelFileError(f"{path.name}: more than {LARGEST // 2**20} MB")
        text = path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise PathError(f"cannot read {path}: {error.strerror}") from None
    except UnicodeDecodeError:
        raise ModelFileError(f"{path.name}: no text in UTF-8") from None
    model = Model(path.stem, path, floating=floating)
    reader(model, text)
    return model
