"""Parsers of the command line's values."""

from __future__ import annotations

import functools
import math
import os
import re
from collections.abc import Callable, Collection, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias, TypeVar

import click

from ..base.numerals import real, whole
from ..base.vocabulary import BACKENDS, PRECISIONS
from ..errors import DeclarationError

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

    from ..declare.even_points import EvenPoints
    from ..declare.times import Over
    from ..studies.sweep import Axis

EVEN_POINTS = "START:STOP:COUNT"
OVER = "JOINT=START:STOP:COUNT"
BOUNDS = "NAME=LEAST:LARGEST"
HDF5 = (".h5", ".hdf5")
"""Endings of the files of results."""

AXIS = "NAME=START:STOP:COUNT[:log]|NAME=VALUE,..."

Number = TypeVar("Number")
Kind: TypeAlias = "click.ParamType[Any] | Callable[[str], object]"
"""Reader of an option's value."""


class _Path(click.Path):
    """A path, which an empty text is not: that of a variable of the shell which is not set would be
    the folder where one is.
    """

    def convert(
        self,
        value: str | os.PathLike[str],
        parameter: click.Parameter | None,
        context: click.Context | None,
    ) -> str | bytes | os.PathLike[str]:
        """The path that is given."""
        if value == "":
            self.fail("expected a path, got ''", parameter, context)
        return super().convert(value, parameter, context)


class _Case(_Path):
    """The path of a case, or the name of one that comes with the package."""

    def shell_complete(
        self, ctx: click.Context, param: click.Parameter, incomplete: str
    ) -> list[CompletionItem]:
        """Names of cases, and files."""
        from click.shell_completion import CompletionItem

        from ..shipped_cases import shipped_cases

        names = [name for name in shipped_cases() if name.startswith(incomplete)]
        return [*super().shell_complete(ctx, param, incomplete), *map(CompletionItem, names)]


PATH = _Path(path_type=Path)
CASE = _Case(path_type=Path)


def even_points(text: str) -> EvenPoints:
    """START:STOP:COUNT, both ends included; START and STOP may have a unit, as 80ms."""
    try:
        start, stop, count = text.split(":")
        return _value(start), _value(stop), whole(count)
    except ValueError:
        raise click.BadParameter(
            f"expected START:STOP:COUNT, as in 0:0.08:801, got '{text}'"
        ) from None


def steps_over(text: str) -> Over:
    """JOINT=START:STOP:COUNT; which units START and STOP may have is the joint's affair."""
    try:
        joint, steps = (part.strip() for part in text.split("="))
        start, stop, count = steps.split(":")
        return joint, _value(start), _value(stop), whole(count)
    except ValueError:
        raise click.BadParameter(f"expected {OVER}, as in O=0:720deg:721, got '{text}'") from None


def axis(text: str) -> tuple[str, Axis]:
    """NAME=START:STOP:COUNT, NAME=START:STOP:COUNT:log or NAME=VALUE,VALUE,...; numbers may have a
    unit, as 30deg.
    """
    from ..studies.sweep import Range, Values

    name, words = (word.strip() for word in text.partition("=")[::2])
    parts = words.split(":")
    if not (name and words) or len(parts) not in (1, 3, 4):
        raise click.BadParameter(
            "expected NAME=START:STOP:COUNT, NAME=START:STOP:COUNT:log or NAME=VALUE,VALUE,..., as"
            f" in l=0.1:0.4:31, got '{text}'"
        )
    try:
        if len(parts) == 1:
            return name, Values(
                tuple(
                    _read(_value, "a number for each value", word, words)
                    for word in words.split(",")
                )
            )
        ends = zip(("START", "STOP"), parts, strict=False)
        start, stop = (_read(_value, f"a number for {end}", word, words) for end, word in ends)
        count = _read(whole, "a whole number for COUNT", parts[2], words)
        if parts[3:] not in ([], ["log"]):
            raise DeclarationError(
                f"expected log or nothing after COUNT, got '{parts[3]}' in {words}"
            )
        return name, Range(start, stop, count, len(parts) == 4)
    except DeclarationError as error:
        raise click.BadParameter(f"{name}: {error}") from None


def length(text: str) -> float:
    """A length, which may have a unit, as 5mm."""
    from ..base.units import number

    try:
        return number(_value(text), "m", finite=False)
    except ValueError:
        raise click.BadParameter(
            f"expected a length [m], as in 0.005 or 5mm, got '{text}'"
        ) from None


def setting(text: str) -> tuple[str, float | str]:
    """NAME=VALUE; a value with a unit remains a text, and is checked later."""
    name, equals, value = (word.strip() for word in text.partition("="))
    with suppress(ValueError):
        if equals:
            return name, _value(value)
    raise click.BadParameter(
        f"expected NAME=VALUE with a number in SI units, as in l=0.25 or phi=30deg, got '{text}'"
    )


def pair(text: str) -> tuple[str, str]:
    """NAME=NAME."""
    name, _, other = (word.strip() for word in text.partition("="))
    if not name or not other:
        raise click.BadParameter(f"expected NAME=NAME, got '{text}'")
    return name, other


def counts(text: str) -> tuple[str, float]:
    """NAME=NUMBER; or NUMBER, which is for all names, as the empty one."""
    name, equals, word = (part.strip() for part in text.rpartition("="))
    with suppress(ValueError):
        if bool(name) == bool(equals):
            return name, real(word)
    raise click.BadParameter(f"expected NUMBER or NAME=NUMBER, as in 4096 or O=4096, got '{text}'")


def place(text: str) -> tuple[str, float | str]:
    """NAME=VALUE, the value finite."""
    name, value = setting(text)
    if isinstance(value, float) and not math.isfinite(value):
        raise click.BadParameter(f"{name}: expected a finite number, got {value}")
    return name, value


def parameters(settings: Sequence[tuple[str, float | str]]) -> dict[str, Any]:
    """Settings as a mapping. Raises ``click.UsageError`` for a parameter set twice."""
    found: dict[str, Any] = {}
    for name, value in settings:
        if name in found:
            raise click.UsageError(f"--set: parameter '{name}' is set twice")
        found[name] = value
    return found


def asked(options: Mapping[str, object]) -> dict[str, Any]:
    """Options as a study takes them: ``settings`` as its ``parameters``, and ``want`` as what is
    ``wanted``, None if nothing is named.
    """
    found: dict[str, Any] = dict(options)
    if "settings" in found:
        found["parameters"] = parameters(found.pop("settings"))
    if "want" in found:
        found["wanted"] = found.pop("want") or None
    return found


def check_ending(option: str, path: Path, endings: Collection[str]) -> None:
    """Raise ``click.UsageError`` for the name of a file that has none of some endings."""
    if path.suffix not in endings:
        raise click.UsageError(
            f"{option} {path}: expected a name that ends in {' or '.join(endings)}"
        )


def separated(
    _context: click.Context, _parameter: click.Parameter, words: Sequence[str]
) -> tuple[str, ...]:
    """Names of an option that is repeatable, and of which one may hold several, with commas
    between.
    """
    return tuple(name.strip() for word in words for name in word.split(","))


def table(text: str) -> float:
    """A number of nodes, or an accuracy."""
    try:
        return int(text) if re.fullmatch(r"[0-9]+", text) else real(text)
    except ValueError:
        raise click.BadParameter(
            f"expected a number of nodes or an accuracy, as in 128 or 1e-6, got '{text}'"
        ) from None


def bounds(text: str) -> tuple[str, tuple[float | str, float | str]]:
    """NAME=LEAST:LARGEST; numbers may have a unit, as 30deg."""
    name, _, words = (word.strip() for word in text.partition("="))
    try:
        low, high = (_value(word) for word in words.split(":"))
    except ValueError:
        raise click.BadParameter(f"expected {BOUNDS}, as in l=0.15:0.4, got '{text}'") from None
    return name, (low, high)


def tolerance(text: str) -> tuple[str, str]:
    """NAME=VALUE; the parameter's unit decides which values are allowed."""
    name, equals, value = (word.strip() for word in text.partition("="))
    if not (name and equals and value):
        raise click.BadParameter(f"expected NAME=VALUE, as in l=0.1mm or m1=1%, got '{text}'")
    return name, value


def share(text: str) -> float:
    """A positive number, or one over another."""
    above, _, below = text.partition("/")
    try:
        found = real(above) / real(below or "1")
    except (ValueError, ZeroDivisionError):
        found = math.nan
    if not 0.0 < found < math.inf:
        raise click.BadParameter(f"expected a share of the length, as 1/500, got {text!r}")
    return found


def ratios(
    context: click.Context, option: click.Parameter, words: Sequence[str]
) -> tuple[float, ...]:
    """Numbers other than 0, of an option that is repeatable, with commas between several."""
    found = []
    for word in separated(context, option, words):
        try:
            found.append(real(word))
        except ValueError:
            found.append(math.nan)
        if not math.isfinite(found[-1]) or found[-1] == 0.0:
            raise click.BadParameter(
                f"expected numbers other than 0, as in 5 or 5,10,20, got '{word}'"
            )
    return tuple(found)


def _value(word: str) -> Any:
    """A number, or the text of one with a unit. Raises ``ValueError`` for anything else."""
    from ..base.units import typed

    return word if typed(word)[1] else real(word)


def _read(read: Callable[[str], Number], what: str, word: str, words: str) -> Number:
    """A number among words. Raises :class:`DeclarationError` that names it."""
    try:
        return read(word)
    except ValueError:
        raise DeclarationError(
            f"expected {what}, got {repr(word) if word.strip() else 'nothing'} in {words}"
        ) from None


def _together(*options: Option) -> Option:
    """Several options as one."""

    def decorate(command: Declared) -> Declared:
        for option in reversed(options):
            command = option(command)
        return command

    return decorate


def value(
    name: str, kind: Kind, metavar: str, says: str, *, default: float | None = None
) -> Option:
    """A value of a kind, which help shows if it has a default."""
    shown = default is not None
    return click.option(
        name, type=kind, metavar=metavar, default=default, show_default=shown, help=says
    )


def several(
    name: str,
    metavar: str,
    says: str,
    *,
    kind: Kind | None = None,
    into: str = "",
    required: bool = False,
    callback: Callable[..., Any] | None = None,
) -> Option:
    """Values of an option that is repeatable, for the argument ``into``."""
    names = [name, into] if into else [name]
    return click.option(
        *names,
        type=kind,
        multiple=True,
        required=required,
        callback=callback,
        metavar=metavar,
        help=says,
    )


def choice(name: str, words: Sequence[str], default: str, says: str) -> Option:
    """One of some words."""
    return click.option(
        name, type=click.Choice(words), default=default, show_default=True, help=says
    )


def flag(name: str, says: str, *, into: str = "") -> Option:
    """A switch, for the argument ``into``."""
    names = [name, into] if into else [name]
    return click.option(*names, is_flag=True, help=says)


def file(name: str, says: str, *, metavar: str | None = None, required: bool = False) -> Option:
    """The path of a file or folder."""
    return click.option(name, type=PATH, metavar=metavar, required=required, help=says)


def backend(designs: str = "") -> Option:
    """Backend of an evaluation, or of ``" designs"``."""
    return choice(
        "--backend",
        BACKENDS,
        "auto",
        f"Evaluate{designs} with SIMD in C++ (lanes), with C, or with CasADi's virtual machine"
        " (vm).",
    )


_PRECISION = choice(
    "--precision", PRECISIONS, "double", "Compute in double or in single precision."
)
_NEWTON = value(
    "--newton",
    int,
    "STEPS",
    "Close iterated loops by this number of Newton steps from the instant before; default: until"
    " they close.",
)
_TABLE = value(
    "--table",
    table,
    "NODES|ACCURACY",
    "Interpolate outputs in a table over one turn, with this number of nodes or this accuracy.",
)
_FLAGS = click.option(
    "--flags",
    default="",
    metavar="FLAGS",
    help="Pass these further flags to the compiler, as one word.",
)

Declared = Callable[..., int | None] | click.Command
"""A command in the making: its function, or what options have made of it."""

Option = Callable[[Declared], Declared]


def settings_by(
    says: str = "Set a parameter, in SI units or with a unit, as l=0.25 or phi=30deg; repeatable.",
) -> Option:
    """Values of parameters: ``settings``, to be read by :func:`parameters`."""
    return several("--set", "NAME=VALUE", says, kind=setting, into="settings")


def instants(
    says: str = "Set the instants [s], both ends included; default: those of the case.",
) -> Option:
    """Instants by their times: ``t``."""
    return value("--t", even_points, EVEN_POINTS, says)


def wanted(
    says: str = "Compute these outputs: effort, reaction:JOINT, section:LINK, motion, a kind such"
    " as section, or all; repeatable. Default: those of the case.",
) -> Option:
    """Names of outputs: ``want``."""
    return click.option("--want", multiple=True, callback=separated, metavar="OUTPUT", help=says)


def table_file(says: str) -> Option:
    """Place of a table, ``csv``, and the marks in it."""

    def decorate(command: Callable[..., object]) -> Callable[..., None]:
        @click.option(
            "--csv",
            type=PATH,
            metavar="FILE.csv|FILE.xlsx",
            help=f"{says} A name that ends in .xlsx makes a workbook.",
        )
        @click.option(
            "--decimal-comma",
            is_flag=True,
            help="With --csv: write commas in numbers, and semicolons between cells.",
        )
        @functools.wraps(command)
        def with_table(csv: Path | None, decimal_comma: bool, **given: object) -> None:
            if decimal_comma and csv is None:
                raise click.UsageError("--decimal-comma goes with --csv FILE.csv")
            from ..base.table_file import TableFile

            command(csv=csv and TableFile(csv, decimal_comma), **given)

        return with_table

    return decorate


over = value(
    "--over",
    steps_over,
    OVER,
    "Set the instants as equal steps of a driven joint's coordinate [rad or m, or with a unit, as"
    " 720deg], in place of --t.",
)
"""Instants by a drive."""

at_values = _together(settings_by(), instants(), over)
"""Values of parameters, and instants by their times or by a drive."""


def resumable(what: str) -> Option:
    """Continuation of ``what`` may have been stopped, or a new start."""
    return _together(
        flag("--resume", f"Continue a {what} that was stopped; start it if there is none."),
        flag("--force", "Start anew and replace the file."),
    )


def conditions(rows: str) -> Option:
    """Conditions on ``rows``: ``where``."""
    return several(
        "--where",
        "NAME<NUMBER",
        f"Choose only {rows} that satisfy this: <, <=, >, >=, == or !=, in SI units; repeatable.",
    )


method = _together(backend(), _PRECISION, _NEWTON, _TABLE, _FLAGS)
"""The options of a :class:`.EvaluationMethod`."""

untabled_method = _together(backend(), _PRECISION, _NEWTON, _FLAGS)
"""Options of an evaluation without a table."""

arithmetic = _together(_PRECISION, _NEWTON, _TABLE)
"""Options that do not concern the compiler."""


svg = flag("--svg", "Draw figures as SVG, in place of PNG.")
