"""``lagrange-casadi check``: is a file whole and consistent?"""

from __future__ import annotations

from pathlib import Path

import click

from ..optimise.file import check_optimum, is_optimum
from ..store import runs as store
from ..sweep import is_sweep
from ..sweep.checking import check_sweep, progress, unfinished
from ..system.seal import kind_of

_UNSEALED = ", as far as can be told: files of schema version 1 have no digest of all of it"


@click.command()
@click.argument("file", metavar="FILE.h5|FILE.h5.parts", type=click.Path(path_type=Path))
def check(file: Path) -> int:
    """Read all of FILE.h5 and verify it: exit status 0 if nothing is wrong with it, else 1."""
    findings = _findings(file)
    for finding in findings:
        click.echo(f"{file}: {finding}", err=True)
    if not findings:
        click.echo(f"{file}: whole and consistent" + ("" if kind_of(file) else _UNSEALED))
    return 1 if findings else 0


def _findings(file: Path) -> list[str]:
    folder = unfinished(file)
    if folder:
        return [progress(folder), *folder.flaws()]
    if is_optimum(file):
        return check_optimum(file)
    return check_sweep(file) if is_sweep(file) else store.check(file)
