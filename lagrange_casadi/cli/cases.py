"""``lagrange-casadi cases``: the cases that come with the package, to look at and to begin with."""

from __future__ import annotations

import ast
import shutil
from importlib import metadata
from pathlib import Path

import click

from ..errors import PathError, StoreError

_IN_A_CLONE = Path(__file__).parents[2] / "cases"


@click.command()
@click.option("--copy", type=click.Path(path_type=Path), metavar="FOLDER", help="Copy all of them into a new folder.")
def cases(copy: Path | None) -> None:
    """List the cases that come with the package, or copy them."""
    found = _found()
    if copy is None:
        for name, folder in found.items():
            click.echo(f"{name:18} {_sentence(folder / 'case.py')}")
        return
    if copy.exists():
        raise PathError(f"{copy} exists: expected a new folder")
    try:
        for name, folder in found.items():
            shutil.copytree(folder, copy / name, ignore=shutil.ignore_patterns("__pycache__"))
    except OSError as error:
        raise StoreError(f"cannot write {copy}: {error.strerror or error}") from None
    click.echo(f"copied {len(found)} cases: begin with lagrange-casadi run {copy / next(iter(found))}")


def _found() -> dict[str, Path]:
    """The folders of the cases by name: of an installation what its record tells, else those of a clone."""
    recorded = [Path(str(file.locate())) for file in metadata.files("lagrange_casadi") or () if file.match("cases/*/case.py")]
    there = [path.parent for path in recorded if path.is_file()] or [path.parent for path in _IN_A_CLONE.glob("*/case.py")]
    if not there:
        raise PathError("the cases were not installed with the package: they are in its repository")
    return {folder.name: folder for folder in sorted(there)}


def _sentence(file: Path) -> str:
    """The first line of what a case says of itself."""
    return (ast.get_docstring(ast.parse(file.read_text(encoding="utf-8"))) or "").partition("\n")[0]
