"""``lagrange-casadi cases``: the cases that come with the package, to look at and to begin with."""

from __future__ import annotations

import ast
import shutil
from pathlib import Path

import click

from ..errors import PathError, StoreError
from ..shipped_cases import shipped_cases


@click.command()
@click.option("--copy", type=click.Path(path_type=Path), metavar="FOLDER", help="Copy all of them into a new folder.")
def cases(copy: Path | None) -> None:
    """List the cases that come with the package, or copy them. Each is run by its name, as in run four_bar."""
    found = shipped_cases()
    if not found:
        raise PathError("the cases were not installed with the package: they are in its repository")
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


def _sentence(file: Path) -> str:
    """The first line of what a case says of itself."""
    return (ast.get_docstring(ast.parse(file.read_text(encoding="utf-8"))) or "").partition("\n")[0]
