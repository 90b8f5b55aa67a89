"""How the command line's words are read."""

from __future__ import annotations

from collections.abc import Sequence

import click

from ..scene import Grid


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
