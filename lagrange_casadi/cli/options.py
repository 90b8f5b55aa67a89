"""How the command line's words are read."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from typing import Any

import click

from ..compensated import PRECISIONS
from ..errors import DeclarationError
from ..rung import BACKENDS
from ..scene import Grid
from ..sweep import Axis, Range, Values

GRID = "START:STOP:COUNT"
AXIS = "NAME=START:STOP:COUNT[:log]|NAME=VALUE,..."


def grid(text: str) -> Grid:
    """START:STOP:COUNT, both ends included."""
    try:
        start, stop, count = text.split(":")
        return float(start), float(stop), int(count)
    except ValueError:
        raise click.BadParameter(f"expected START:STOP:COUNT, as in 0:0.08:801, got '{text}'") from None


def axis(text: str) -> tuple[str, Axis]:
    """NAME=START:STOP:COUNT, NAME=START:STOP:COUNT:log or NAME=VALUE,VALUE,..."""
    name, equals, words = text.partition("=")
    try:
        if not (equals and name.strip()):
            raise ValueError
        if ":" not in words:
            return name.strip(), Values(tuple(float(word) for word in words.split(",")))
        start, stop, count, *log = words.split(":")
        if log not in ([], ["log"]):
            raise ValueError
        return name.strip(), Range(float(start), float(stop), int(count), bool(log))
    except ValueError:
        raise click.BadParameter(
            f"expected NAME=START:STOP:COUNT, NAME=START:STOP:COUNT:log or NAME=VALUE,VALUE,..., as in l=0.1:0.4:31, got '{text}'"
        ) from None
    except DeclarationError as error:
        raise click.BadParameter(f"{name.strip()}: {error}") from None


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


def _together(*options: Callable[..., Any]) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Several options as one."""

    def decorate(command: Callable[..., Any]) -> Callable[..., Any]:
        for option in reversed(options):
            command = option(command)
        return command

    return decorate


_BACKEND = click.option(
    "--backend", type=click.Choice(BACKENDS), default="auto", show_default=True, help="Packs in C++, C, or CasADi's VM."
)
_PRECISION = click.option(
    "--precision", type=click.Choice(PRECISIONS), default="double", show_default=True, help="Of the arithmetic."
)
_NEWTON = click.option(
    "--newton", type=int, metavar="STEPS", help="Close every loop by so many Newton steps from the instant before."
)
_TABLE = click.option("--table", type=table, metavar="NODES|ACCURACY", help="Read outputs from a table over a turn.")
_FLAGS = click.option("--flags", default="", metavar="FLAGS", help="Further flags of the compiler, as one word.")

rung = _together(_BACKEND, _PRECISION, _NEWTON, _TABLE, _FLAGS)
"""The options of a :class:`.Rung`."""

untabled_rung = _together(_BACKEND, _PRECISION, _NEWTON, _FLAGS)
"""Those of one that reads no table."""

arithmetic = _together(_PRECISION, _NEWTON, _TABLE)
"""Those that are no compiler's affair."""
