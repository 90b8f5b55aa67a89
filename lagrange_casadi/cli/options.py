"""Parsers of the command line's values."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias, TypeVar

import click

from ..base.numerals import real, whole
from ..base.vocabulary import BACKENDS, COMPILED, PRECISIONS
from ..errors import DeclarationError
from .help import Body

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

    from ..base.table_file import TableFile
    from ..model.even_points import EvenPoints
    from ..model.times import Over
    from ..studies.sweep import Axis

EVEN_POINTS = "START:STOP:COUNT"
OVER = "JOINT=START:STOP:COUNT"
BOUNDS = "NAME=LEAST:LARGEST"
HDF5 = (".h5", ".hdf5")
"""Endings of the files of results."""

_COMMA = f"{__name__}.decimal_comma"
"""The flag in a context's notes, which is read before the file that it is about."""

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

        from ..base.shipped_cases import shipped_cases

        names = [name for name in shipped_cases() if name.startswith(incomplete)]
        return [*super().shell_complete(ctx, param, incomplete), *map(CompletionItem, names)]


PATH = _Path(path_type=Path)
CASE = _Case(path_type=Path)


def even_points(text: str) -> EvenPoints:
    """START:STOP:COUNT, both ends included; START and STOP may have a unit, as 80ms."""
    with _expected("START:STOP:COUNT, as in 0:0.08:801", text):
        start, stop, count = text.split(":")
        return _value(start), _value(stop), whole(count)


def steps_over(text: str) -> Over:
    """JOINT=START:STOP:COUNT; which units START and STOP may have is the joint's affair."""
    with _expected(f"{OVER}, as in O=0:720deg:721", text):
        joint, steps = _named(text)
        start, stop, count = steps.split(":")
        return joint, _value(start), _value(stop), whole(count)


def axis(text: str) -> tuple[str, Axis]:
    """NAME=START:STOP:COUNT, NAME=START:STOP:COUNT:log or NAME=VALUE,VALUE,...; numbers may have a
    unit, as 30deg.
    """
    from ..studies.sweep import Range, Values

    with _expected(
        "NAME=START:STOP:COUNT, NAME=START:STOP:COUNT:log or NAME=VALUE,VALUE,..., as in"
        " l=0.1:0.4:31",
        text,
    ):
        name, words = _named(text)
        parts = words.split(":")
        if len(parts) not in (1, 3, 4):
            raise ValueError(text)
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

    with _expected("a length [m], as in 0.005 or 5mm", text):
        return number(_value(text), "m", finite=False)


def setting(text: str) -> tuple[str, float | str]:
    """NAME=VALUE; a value with a unit remains a text, and is checked later."""
    with _expected("NAME=VALUE with a number in SI units, as in l=0.25 or phi=30deg", text):
        name, word = _named(text)
        return name, _value(word)


def counts(text: str) -> tuple[str, float]:
    """NAME=NUMBER; or NUMBER, which is for all names, as the empty one."""
    with _expected("NUMBER or NAME=NUMBER, as in 4096 or O=4096", text):
        name, word = _named(text) if "=" in text else ("", text)
        return name, real(word)


def place(text: str) -> tuple[str, float | str]:
    """NAME=VALUE, the value finite."""
    name, value = setting(text)
    if isinstance(value, float) and not math.isfinite(value):
        raise click.BadParameter(f"{name}: expected a finite number, got {value}")
    return name, value


def pair(text: str) -> tuple[str, str]:
    """NAME=NAME."""
    with _expected("NAME=NAME", text):
        return _named(text)


def tolerance(text: str) -> tuple[str, str]:
    """NAME=VALUE; the parameter's unit decides which values are allowed."""
    with _expected("NAME=VALUE, as in l=0.1mm or m1=1%", text):
        return _named(text)


def bounds(text: str) -> tuple[str, tuple[float | str, float | str]]:
    """NAME=LEAST:LARGEST; numbers may have a unit, as 30deg."""
    with _expected(f"{BOUNDS}, as in l=0.15:0.4", text):
        name, words = _named(text)
        low, high = (_value(word) for word in words.split(":"))
        return name, (low, high)


def table(text: str) -> float:
    """A number of nodes, or an accuracy."""
    with _expected("a number of nodes or an accuracy, as in 128 or 1e-6", text):
        return int(text) if re.fullmatch(r"[0-9]+", text) else real(text)


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


def separated(
    _context: click.Context, _option: click.Parameter, words: Sequence[str]
) -> tuple[str, ...] | None:
    """Names of an option that is repeatable, and of which one may hold several, with commas
    between; None if there are none.
    """
    return tuple(name.strip() for word in words for name in word.split(",")) or None


def ratios(
    context: click.Context, option: click.Parameter, words: Sequence[str]
) -> tuple[float, ...]:
    """Numbers other than 0, of an option that is repeatable, with commas between several."""
    found = []
    for word in separated(context, option, words) or ():
        try:
            found.append(real(word))
        except ValueError:
            found.append(math.nan)
        if not math.isfinite(found[-1]) or found[-1] == 0.0:
            raise click.BadParameter(
                f"expected numbers other than 0, as in 5 or 5,10,20, got '{word}'"
            )
    return tuple(found)


def target(option: str, given: Path | None, usual: str, endings: Collection[str]) -> Path:
    """The file that an option names, else the ``usual`` one. Raises ``click.UsageError`` for a name
    that has none of some endings.
    """
    path = given or Path(usual)
    if path.suffix not in endings:
        raise click.UsageError(
            f"{option} {path}: expected a name that ends in {' or '.join(endings)}"
        )
    return path


@contextmanager
def _expected(what: str, text: str) -> Iterator[None]:
    """Say what was expected in place of a text that cannot be read."""
    try:
        yield
    except ValueError:
        raise click.BadParameter(f"expected {what}, got '{text}'") from None


def _named(text: str) -> tuple[str, str]:
    """Split NAME=WORDS. Raises ``ValueError`` if one of them is missing."""
    name, words = (part.strip() for part in text.partition("=")[::2])
    if not (name and words):
        raise ValueError(text)
    return name, words


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


def _names(name: str, into: str) -> list[str]:
    """An option's name, and that of its argument if it has another one."""
    return [name, into] if into else [name]


def value(
    name: str,
    kind: Kind,
    metavar: str,
    says: str,
    *,
    default: float | None = None,
    shown: bool = True,
) -> Option:
    """A value of a kind; help shows its default if it has one and that is to be ``shown``."""
    return click.option(
        name,
        type=kind,
        metavar=metavar,
        default=default,
        show_default=shown and default is not None,
        help=says,
    )


def several(
    name: str,
    metavar: str | None,
    says: str,
    *,
    kind: Kind | None = None,
    into: str = "",
    required: bool = False,
    callback: Callable[..., Any] | None = None,
) -> Option:
    """Values of an option that is repeatable, for the argument ``into``."""
    return click.option(
        *_names(name, into),
        type=kind,
        multiple=True,
        required=required,
        callback=callback,
        metavar=metavar,
        help=says,
    )


def named(
    name: str,
    metavar: str,
    says: str,
    *,
    kind: Kind,
    into: str,
    required: bool = False,
    twice: str = "parameter '{}' is set twice",
) -> Option:
    """Pairs NAME=... of an option that is repeatable, for the argument ``into``, a mapping.

    ``twice`` is what is said of a name that has two.
    """

    def mapping(
        _context: click.Context, _option: click.Parameter, pairs: Sequence[tuple[str, object]]
    ) -> dict[str, object]:
        found: dict[str, object] = {}
        for one, value in pairs:
            if one in found:
                raise click.UsageError(f"{name}: {twice.format(one)}")
            found[one] = value
        return found

    return several(name, metavar, says, kind=kind, into=into, required=required, callback=mapping)


def choice(name: str, words: Sequence[str], default: str, says: str, *, into: str = "") -> Option:
    """One of some words, for the argument ``into``."""
    return click.option(
        *_names(name, into),
        type=click.Choice(words),
        default=default,
        show_default=True,
        help=says,
    )


def flag(name: str, says: str, *, into: str = "") -> Option:
    """A switch, for the argument ``into``."""
    return click.option(*_names(name, into), is_flag=True, help=says)


def file(name: str, says: str, *, metavar: str | None = None, required: bool = False) -> Option:
    """The path of a file or folder."""
    return click.option(name, type=PATH, metavar=metavar, required=required, help=says)


_BACKEND = choice(
    "--backend",
    BACKENDS,
    "auto",
    "Evaluate with SIMD in C++ (lanes), with C, or with CasADi's virtual machine (vm).",
)

backend_of_designs = choice(
    "--backend", COMPILED, "auto", "Evaluate designs with SIMD in C++ (lanes), or with C."
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

Declared = Callable[[], Body] | click.Command
"""A command in the making: its function, or what options have made of it."""

Option = Callable[[Declared], Declared]


def settings_by(
    says: str = "Set a parameter, in SI units or with a unit, as l=0.25 or phi=30deg; repeatable.",
) -> Option:
    """Values of parameters: ``parameters``."""
    return named("--set", "NAME=VALUE", says, kind=setting, into="parameters")


def instants(
    says: str = "Set the instants [s], both ends included; default: those of the case.",
) -> Option:
    """Instants by their times: ``t``."""
    return value("--t", even_points, EVEN_POINTS, says)


def wanted(
    says: str = "Compute these outputs: effort, reaction:JOINT, section:LINK, motion, a kind such"
    " as section, or all; repeatable. Default: those of the case.",
) -> Option:
    """Names of outputs: ``wanted``, None if there are none."""
    return several("--want", "OUTPUT", says, into="wanted", callback=separated)


def table_file(says: str) -> Option:
    """Place of a table, ``csv``, and the marks in it."""

    def remember(context: click.Context, _option: click.Parameter, comma: bool) -> None:
        context.meta[_COMMA] = comma

    def read(
        context: click.Context, _option: click.Parameter, path: Path | None
    ) -> TableFile | None:
        from ..base.table_file import TableFile

        if path is not None:
            table = TableFile(path, context.meta[_COMMA])
            table.check()
            return table
        if context.meta[_COMMA]:
            raise click.UsageError("--decimal-comma goes with --csv FILE.csv")
        return None

    return _together(
        click.option(
            "--csv",
            type=PATH,
            callback=read,
            metavar="FILE.csv|FILE.xlsx",
            help=f"{says} A name that ends in .xlsx makes a workbook.",
        ),
        click.option(
            "--decimal-comma",
            is_flag=True,
            is_eager=True,
            expose_value=False,
            callback=remember,
            help="With --csv: write commas in numbers, and semicolons between cells.",
        ),
    )


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


method = _together(_BACKEND, _PRECISION, _NEWTON, _TABLE, _FLAGS)
"""The options of a :class:`.EvaluationMethod`."""

method_of_designs = _together(backend_of_designs, _PRECISION, _NEWTON, _FLAGS)
"""The options of a method that evaluates designs."""

arithmetic = _together(_PRECISION, _NEWTON, _TABLE)
"""Options that do not concern the compiler."""


svg = flag("--svg", "Draw figures as SVG, in place of PNG.")
