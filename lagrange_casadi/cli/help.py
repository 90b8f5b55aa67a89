"""Help in groups: commands by what they are for, options of engineers before those of the machine.

Help never cuts a description.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from importlib import import_module

import click

from .options import option
from .signatures import parameters, summary

_MACHINE = (
    "backend",
    "precision",
    "newton",
    "table",
    "largest",
    "flags",
    "threads",
    "workers",
    "dask",
    "many",
    "quiet",
    "untrusted",
    "time_limit",
    "no_certificate",
)
"""Options that say how results are computed, by name."""


class Command(click.Command):
    """A command whose help has the options of the machine in a group of their own.

    What it was asked for is noted in the context's ``obj``, for what follows an error.
    """

    def invoke(self, ctx: click.Context) -> object:
        """Run the command."""
        ctx.obj |= ctx.params
        return super().invoke(ctx)

    def format_options(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the options in two groups. Arguments are in the usage, and in the text above."""
        options = [one for one in self.get_params(ctx) if isinstance(one, click.Option)]
        shown = [(one.name in _MACHINE, one.get_help_record(ctx)) for one in options]
        for title, machine in (("Options", False), ("Computation", True)):
            if records := [record for group, record in shown if record and group == machine]:
                with formatter.section(title):
                    formatter.write_dl(records)


def command(place: str) -> Command:
    """Make a command of MODULE.FUNCTION of this package, which is imported when it is run.

    The command has the function's name, is described by the function's docstring, and has its
    parameters as options. A number that the function returns is the exit status.
    """
    module, _, name = place.partition(".")

    def run(**given: object) -> object:
        return getattr(import_module(f".{module}", __package__), name)(**given)

    # Lines of examples are kept.
    says = re.sub(r"\n\n(?=lagrange-casadi )", "\n\n\b\n", summary(f"cli.{place}"))
    options = [*map(option, parameters(f"cli.{place}").values())]
    return Command(name, callback=run, params=options, help=says)


def write_commands(groups: Mapping[str, tuple[str, ...]], formatter: click.HelpFormatter) -> None:
    """Write each group of commands below its name, with the first sentence of each one's help."""
    for name, places in groups.items():
        with formatter.section(name):
            formatter.write_dl([(place.partition(".")[2], _sentence(place)) for place in places])


def _sentence(place: str) -> str:
    """The first paragraph of a command's help."""
    return " ".join(summary(f"cli.{place}").partition("\n\n")[0].split())
