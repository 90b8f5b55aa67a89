"""How the command line's words are read."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import click

from ..scene import Grid


class GridType(click.ParamType[Grid]):
    """START:STOP:COUNT, both ends included."""

    name = "START:STOP:COUNT"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Grid:
        """Read a grid."""
        if isinstance(value, tuple):
            return value
        try:
            start, stop, count = str(value).split(":")
            return float(start), float(stop), int(count)
        except ValueError:
            self.fail(f"expected START:STOP:COUNT, as in 0:0.08:801, got '{value}'", param, ctx)


class SettingType(click.ParamType[tuple[str, float]]):
    """NAME=VALUE."""

    name = "NAME=VALUE"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> tuple[str, float]:
        """Read a setting."""
        if isinstance(value, tuple):
            return value
        name, equals, number = str(value).partition("=")
        try:
            if not equals:
                raise ValueError
            return name.strip(), float(number)
        except ValueError:
            self.fail(f"expected NAME=VALUE with a number, as in l=0.25, got '{value}'", param, ctx)


def parameters(settings: Sequence[tuple[str, float]]) -> dict[str, float]:
    """Settings as a mapping. Raises ``click.UsageError`` for a parameter set twice."""
    found: dict[str, float] = {}
    for name, value in settings:
        if name in found:
            raise click.UsageError(f"--set: parameter '{name}' is set twice")
        found[name] = value
    return found
