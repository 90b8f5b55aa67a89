"""How the command line's words are read."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from typing import Any

import click

from ..compensated import PRECISIONS
from ..rung import BACKENDS
from ..scene import Grid

GRID = "START:STOP:COUNT"


def grid(text: str) -> Grid:
    """START:STOP:COUNT, both ends included."""
    try:
        start, stop, count = text.split(":")
        return float(start), float(stop), int(count)
    except ValueError:
        raise click.BadParameter(f"expected START:STOP:COUNT, as in 0:0.08:801, got '{text}'") from None


def setting(text: str) -> tuple[str, float]:
    """NAME=VALUE."""
    name, equals, number = text.partition("=")
    try:
        if not equals:
            raise ValueError
        return name.strip(), float(number)
    except ValueError:
        raise click.BadParameter(f"expected NAME=VALUE with a number, as in l=0.25, got '{text}'") from None


def parameters(settings: Sequence[tuple[str, float]]) -> dict[str, float]:
    """Settings as a mapping. Raises ``click.UsageError`` for a parameter set twice."""
    found: dict[str, float] = {}
    for name, value in settings:
        if name in found:
            raise click.UsageError(f"--set: parameter '{name}' is set twice")
        found[name] = value
    return found


def table(text: str) -> float:
    """A number of nodes, or an accuracy."""
    try:
        return int(text) if re.fullmatch(r"[0-9]+", text) else float(text)
    except ValueError:
        raise click.BadParameter(f"expected a number of nodes or an accuracy, as in 128 or 1e-6, got '{text}'") from None


def rung(command: Callable[..., Any]) -> Callable[..., Any]:
    """The options of a :class:`.Rung`."""
    command = click.option("--flags", default="", metavar="FLAGS", help="Further flags of the compiler, as one word.")(command)
    command = arithmetic(command)
    about = "Packs in C++, C, or CasADi's VM."
    return click.option("--backend", type=click.Choice(BACKENDS), default="auto", show_default=True, help=about)(command)


def arithmetic(command: Callable[..., Any]) -> Callable[..., Any]:
    """Those options of a :class:`.Rung` that are no compiler's affair."""
    steps = "Close every loop by so many Newton steps from the instant before."
    reading = "Read outputs from a table over a turn."
    command = click.option("--table", type=table, metavar="NODES|ACCURACY", help=reading)(command)
    command = click.option("--newton", type=int, metavar="STEPS", help=steps)(command)
    return click.option("--precision", type=click.Choice(PRECISIONS), default="double", show_default=True)(command)
