"""Parsers of the command line's values."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Callable, Collection, Mapping, Sequence
from functools import partial, wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias, TypeVar, get_args

import click

from ..base import vocabulary
from ..base.files import check_writable
from ..base.numerals import real, whole
from ..base.space import MOST_THREADS
from ..errors import DeclarationError, NumberError
from .signatures import Parameter

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

    from ..base.table_writers import TableFile
    from ..model.even_points import EvenPoints
    from ..model.times import Over
    from ..studies.sweep import Axis

EVEN_POINTS = "START:STOP:COUNT"
OVER = "JOINT=START:STOP:COUNT"
BOUNDS = "NAME=LEAST:LARGEST"
HDF5 = (".h5", ".hdf5")
"""Endings of the files of results."""

AXIS = "NAME=START:STOP:COUNT[:log]|NAME=VALUE,..."

Value = TypeVar("Value")
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


def _reads(what: str) -> Callable[[Callable[[str], Value]], Callable[[str], Value]]:
    """Make a reader say what was expected in place of a text that cannot be read."""

    def decorate(read: Callable[[str], Value]) -> Callable[[str], Value]:
        @wraps(read)
        def reader(text: str) -> Value:
            try:
                return read(text)
            except NumberError as error:  # a number in another unit
                raise click.BadParameter(str(error)) from None
            except (ValueError, ZeroDivisionError):
                raise click.BadParameter(f"expected {what}, got '{text}'") from None

        return reader

    return decorate


def _even_points(text: str) -> EvenPoints:
    """START:STOP:COUNT, both ends included; START and STOP may have a unit, as 80ms."""
    start, stop, count = text.split(":")
    return _value(start), _value(stop), whole(count)


@_reads(f"{OVER}, as in O=0:720deg:721")
def steps_over(text: str) -> Over:
    """JOINT=START:STOP:COUNT; which units START and STOP may have is the joint's affair."""
    joint, steps = _named(text)
    return joint, *_even_points(steps)


@_reads(
    "NAME=START:STOP:COUNT, NAME=START:STOP:COUNT:log or NAME=VALUE,VALUE,..., as in l=0.1:0.4:31"
)
def axis(text: str) -> tuple[str, Axis]:
    """NAME=START:STOP:COUNT, NAME=START:STOP:COUNT:log or NAME=VALUE,VALUE,...; numbers may have a
    unit, as 30deg.
    """
    from ..studies.sweep import Range, Values

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


def _in_unit(unit: str, text: str) -> float:
    """A number, which may have another unit."""
    from ..base.units import number

    return number(_value(text), unit, finite=False)


def _value(word: object) -> Any:
    """A number, or the text of one with a unit, which is checked later; a default is a number
    already.

    Raises ``ValueError`` for anything else.
    """
    from ..base.units import typed

    return word if not isinstance(word, str) or typed(word)[1] else real(word)


measured: Callable[[str], float | str] = _reads("a number in SI units, or one with its unit")(
    _value
)


@_reads("NAME=VALUE with a number in SI units, as in l=0.25 or phi=30deg")
def setting(text: str) -> tuple[str, float | str]:
    """NAME=VALUE; a value with a unit remains a text, and is checked later."""
    name, word = _named(text)
    return name, _value(word)


@_reads("NUMBER or NAME=NUMBER, as in 4096 or O=4096")
def counts(text: str) -> tuple[str, float]:
    """NAME=NUMBER; or NUMBER, which is for all names, as the empty one."""
    name, word = _named(text) if "=" in text else ("", text)
    return name, real(word)


def place(text: str) -> tuple[str, float | str]:
    """NAME=VALUE, the value finite."""
    name, value = setting(text)
    if isinstance(value, float) and not math.isfinite(value):
        raise click.BadParameter(f"{name}: expected a finite number, got {value}")
    return name, value


@_reads(f"{BOUNDS}, as in l=0.15:0.4")
def bounds(text: str) -> tuple[str, tuple[float | str, float | str]]:
    """NAME=LEAST:LARGEST; numbers may have a unit, as 30deg."""
    name, words = _named(text)
    low, high = (_value(word) for word in words.split(":"))
    return name, (low, high)


@_reads("a number of nodes or an accuracy, as in 128 or 1e-6")
def table(text: str) -> float:
    """A number of nodes, or an accuracy."""
    return int(text) if re.fullmatch(r"[0-9]+", text) else real(text)


@_reads("a share of the length, as 1/500")
def share(text: str) -> float:
    """A positive number, or one over another."""
    above, _, below = text.partition("/")
    found = real(above) / real(below or "1")
    if not 0.0 < found < math.inf:
        raise ValueError(text)
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
    return tuple(map(_ratio, separated(context, option, words) or ()))


@_reads("numbers other than 0, as in 5 or 5,10,20")
def _ratio(text: str) -> float:
    found = real(text)
    if not math.isfinite(found) or found == 0.0:
        raise ValueError(text)
    return found


def target(option: str, given: Path | None, usual: str, endings: Collection[str]) -> Path:
    """The file that an option names, else the ``usual`` one. Raises ``click.UsageError`` for a name
    that has none of some endings, and as :func:`.check_writable`.
    """
    path = given or Path(usual)
    refuse(
        (
            path.suffix not in endings,
            f"{option} {path}: expected a name that ends in {' or '.join(endings)}",
        )
    )
    check_writable(path, hdf5=endings is HDF5)
    return path


def _named(text: str) -> tuple[str, str]:
    """Split NAME=WORDS. Raises ``ValueError`` if one of them is missing."""
    name, words = (part.strip() for part in text.partition("=")[::2])
    if not (name and words):
        raise ValueError(text)
    return name, words


def _read(read: Callable[[str], Value], what: str, word: str, words: str) -> Value:
    """A number among words. Raises :class:`DeclarationError` that names it."""
    try:
        return read(word)
    except ValueError:
        raise DeclarationError(
            f"expected {what}, got {repr(word) if word.strip() else 'nothing'} in {words}"
        ) from None


_READERS: Mapping[str, Kind] = {
    EVEN_POINTS: _reads("START:STOP:COUNT, as in 0:0.08:801")(_even_points),
    OVER: steps_over,
    AXIS: axis,
    BOUNDS: bounds,
    "NAME=VALUE": setting,
    "NAME=NUMBER": place,
    "NAME=TOLERANCE": _reads("NAME=VALUE, as in l=0.1mm or m1=1%")(_named),
    "NAME=HEAD": _reads("NAME=NAME")(_named),
    "JOINT=NAME": _reads("NAME=NAME")(_named),
    "NUMBER|NAME=NUMBER": counts,
    "NODES|ACCURACY": table,
    "LENGTH": _reads("a length [m], as in 0.005 or 5mm")(partial(_in_unit, "m")),
    "TORQUE": measured,
    "INERTIA": measured,
    "HZ": _reads("a frequency [Hz], as in 50 or 50Hz")(partial(_in_unit, "1/s")),
    "SECONDS": _reads("a time [s], as in 0.5 or 500ms")(partial(_in_unit, "s")),
    "SHARE": share,
    "N": click.IntRange(1),
    "THREADS": click.IntRange(1, MOST_THREADS),
    "BYTES": click.IntRange(0),
    "CLASSES": click.IntRange(0),
    "Path": PATH,
    "int": int,
    "Count": int,
    "Starts": int,
    **dict.fromkeys(
        ("float", "Positive", "NotNegative"),
        _reads("a number, as in 0.05 or 5%")(partial(_in_unit, "1")),
    ),
}
"""Readers of values, by what stands for them in the help, else by their type."""

_LISTS = {"OUTPUT": separated, "NAME,...": separated, "NUMBER,...": ratios}
"""Readers of all values of an option, by what stands for one of them."""

_SPELLED = {
    "parameters": "--set",
    "wanted": "--want",
    "many": "--yes",
    "within": "--tolerance",
    "names": "--column",
    "columns": "--column",
    "links": "--link",
    "drives": "--drive",
    "ratios": "--ratio",
    "formats": "--format",
    "nodes": "--node",
    "spectra": "--spectrum",
    "bearings": "--bearing",
    "source": "--from",
    "yield_criterion": "--yielding",
}
"""Options that are called other than the parameters."""

_SYNTAX = {
    "parameters": "NAME=VALUE",
    "t": EVEN_POINTS,
    "xi": EVEN_POINTS,
    "over": OVER,
    "wanted": "OUTPUT",
    "newton": "STEPS",
    "table": "NODES|ACCURACY",
    "flags": "FLAGS",
    "threads": "THREADS",
    "workers": "THREADS",
    "csv": "FILE.csv|FILE.xlsx",
}
"""Words that stand for the values of parameters that several commands have."""

_TWICE = {
    "grid": "parameter '{}' is swept twice",
    "at": "a parameter stays at one value, got two for '{}'",
    "over": "parameter '{}' is listed twice",
    "within": "parameter '{}' is listed twice",
    "names": "'{}' is read from two columns",
    "noise": "column '{}' has two",
    "nodes": "'{}' is named twice",
}
"""Complaints about a name that has two values; others are set twice."""


def _mapping(
    _context: click.Context, option: click.Parameter, pairs: Sequence[tuple[str, object]]
) -> dict[str, object]:
    """Values by names, of an option that is repeatable."""
    found: dict[str, object] = {}
    for one, value in pairs:
        if one in found:
            twice = _TWICE.get(str(option.name), "parameter '{}' is set twice")
            raise click.UsageError(f"{option.opts[0]}: {twice.format(one)}")
        found[one] = value
    return found


def _spelled(name: str) -> str:
    """The option of a parameter."""
    return _SPELLED.get(name, f"--{name.replace('_', '-')}")


def option(parameter: Parameter) -> click.Parameter:
    """The argument of a command, or its option, for a parameter.

    What must be named in Python is an option; it is a switch if it is a bool, and repeatable if it
    is a sequence or a mapping. The value may be left out where brackets stand for it.
    """
    name, kind = parameter.name, parameter.kind
    says = re.sub(r"``(\w+)``", lambda one: _spelled(one[1]), parameter.says)
    says = says.replace("``", "").replace("scene", "case")  # which has the scene
    metavar = parameter.metavar or _SYNTAX.get(name) or None
    many = re.search(r"(Sequence|Mapping|tuple)\[|^Outputs", kind) is not None
    if parameter.positional:
        path = CASE if "CASE" in (metavar or name.upper()) else PATH
        return click.Argument([name], type=path, metavar=metavar, nargs=-1 if many else 1)
    spelled = _spelled(name)
    if kind.startswith("bool"):
        words = spelled if kind == "bool" else f"{spelled}/--no-{name}"
        return click.Option([words, name], is_flag=True, default=parameter.value, help=says)
    base = re.findall(r"\w+", kind.replace("Annotated", "").replace("Sequence", ""))[0]
    choices = get_args(getattr(vocabulary, base, None))
    default = None if many else parameter.value
    alone: dict[str, Any] = (
        {"is_flag": False, "flag_value": ""} if (metavar or "").startswith("[") else {}
    )
    return click.Option(
        [spelled, name],
        type=click.Choice(choices) if choices else _READERS.get(metavar or "", _READERS.get(base)),
        nargs=len((metavar or name).split()),
        multiple=many,
        required=parameter.default is None,
        callback=_mapping if "Mapping" in kind else _LISTS.get(metavar or ""),
        metavar=metavar,
        default=default,
        show_default=bool(default),
        help=f"{says} Repeatable." if many else says,
        **alone,
    )


def refuse(*misuses: tuple[object, str]) -> None:
    """Raise ``click.UsageError`` for the first of some misuses that is true."""
    for found, words in misuses:
        if found:
            raise click.UsageError(words)


def table_file(place: Path | None, decimal_comma: bool) -> TableFile | None:
    """The table that ``--csv`` names, with the marks of ``--decimal-comma``."""
    from ..base.table_writers import TableFile

    refuse((decimal_comma and not place, "--decimal-comma goes with --csv FILE.csv"))
    return None if place is None else TableFile(place, decimal_comma)
