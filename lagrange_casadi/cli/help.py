"""Help in groups: commands by what they are for, options of engineers before those of the machine.

Help never cuts a description.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import click

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


Body = Callable[..., int | None]
"""The work of a command with its options; a number that it returns is the exit status."""


class Command(click.Command):
    """A command whose help has the options of the machine in a group of their own.

    Its callback takes nothing and returns its :data:`Body`, which it imports. What it was asked for
    is noted in the context's ``obj``, for what follows an error.
    """

    def invoke(self, ctx: click.Context) -> object:
        """Run the command."""
        if ctx.obj is not None:
            ctx.obj |= ctx.params
        assert self.callback is not None
        return self.callback()(**ctx.params)

    def format_options(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the options in two groups."""
        groups: dict[str, list[tuple[str, str]]] = {"Options": [], "Computation": []}
        for parameter in self.get_params(ctx):
            record = parameter.get_help_record(ctx)
            if isinstance(parameter, click.Option) and record:
                groups["Computation" if parameter.name in _MACHINE else "Options"].append(record)
        for name, records in groups.items():
            if records:
                with formatter.section(name):
                    formatter.write_dl(records)


def command(imports: Callable[[], Body]) -> Command:
    """Declare a command: of the function's name, described by its docstring, to do what it
    returns.
    """
    return click.command(cls=Command)(imports)


def write_commands(
    groups: Mapping[str, tuple[click.Command, ...]], formatter: click.HelpFormatter
) -> None:
    """Write each group of commands below its name, with the first sentence of each one's help."""
    for name, commands in groups.items():
        with formatter.section(name):
            formatter.write_dl([(str(one.name), _sentence(one)) for one in commands])


def _sentence(one: click.Command) -> str:
    """The first paragraph of a command's help."""
    return " ".join((one.help or "").partition("\n\n")[0].split())
