"""Arguments of public functions, looked at in one place: numbers, texts with a unit, counts, and
the kinds that signatures name.
"""

from __future__ import annotations

import functools
import inspect
import os
import sys
import types
import typing
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from contextlib import suppress
from itertools import chain, repeat
from numbers import Integral
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple, ParamSpec, TypeAlias, TypeVar

import casadi as ca
import numpy as np

from ..errors import DeclarationError, shown
from .space import MOST_THREADS
from .units import Within, double, in_si, in_words, number, numbers_in, typed

Thing = TypeVar("Thing", bound=Callable[..., Any])
_P = ParamSpec("_P")
_Result = TypeVar("_Result")

_OWN = ("Body", "Point", "Joint", "Link", "Density", "Beam")
"""Parts of mechanisms: declarations look at these themselves, for they list what is valid."""


def public(thing: Thing) -> Thing:
    """A function for users, or a class: it raises :class:`DeclarationError` for arguments of other
    kinds than its signature names.

    So it does for arguments that it does not take, and for those that it lacks. Of a class, methods
    are meant whose names have no underscore, and what makes an instance of a dataclass.
    """
    if not isinstance(thing, type):
        return typing.cast(Thing, _looking(thing))
    for name, method in list(vars(thing).items()):
        if isinstance(method, classmethod | staticmethod) and not name.startswith("_"):
            setattr(thing, name, type(method)(_looking(method.__func__)))
        elif inspect.isfunction(method) and (
            not name.startswith("_") or name in ("__init__", "__getitem__", "__call__")
        ):
            setattr(thing, name, _looking(method))
    return thing


def fitting(thing: Thing) -> Thing:
    """A function for users, or a class, that looks at kinds of arguments itself: it refuses calls
    that do not fit its signature.
    """
    if not isinstance(thing, type):
        return typing.cast(Thing, _looking(thing, kinds=False))
    type.__setattr__(thing, "__init__", _looking(vars(thing)["__init__"], kinds=False))
    return thing


class _Kind(NamedTuple):
    """A kind of values, in words; ``read`` makes of one what the function takes, and None of what
    is of another kind. None itself is taken where it is ``optional``.
    """

    words: str
    read: Callable[[Any], Any]
    optional: bool = False


def _looking(function: Callable[_P, _Result], kinds: bool = True) -> Callable[_P, _Result]:
    """A function that looks at the kinds of its arguments before it runs, and at whether they fit
    where Python finds that something does not.
    """

    @functools.cache
    def asked() -> tuple[dict[str, tuple[_Kind | None, object]], Sequence[str], str]:
        # A module's names are not all there when it is read.
        each = inspect.signature(function).parameters.values()
        scope = vars(sys.modules[function.__module__])
        known = {
            one.name: (_said(one.annotation, scope) if kinds else None, one.default) for one in each
        }
        names = [one.name for one in each if one.kind <= inspect.Parameter.POSITIONAL_OR_KEYWORD]
        rest = (one.name for one in each if one.kind is inspect.Parameter.VAR_POSITIONAL)
        return known, names, next(rest, "")

    @functools.wraps(function)
    def called(*given: _P.args, **named: _P.kwargs) -> _Result:
        known, names, rest = asked()

        def read(name: str, value: Any) -> Any:
            kind, default = known.get(name, (None, None))
            if kind is None or value is default or (value is None and kind.optional):
                return value
            found, why = None, ""
            try:
                found = kind.read(value)
            except DeclarationError as error:
                why = str(error)
            if found is None:
                what = f"{_called(function)}{_part(names, given)}: {name}"
                why = why or f"expected {kind.words}, got {shown(value)}"
                raise DeclarationError(f"{what}: {why}")
            return found

        placed: Any = map(read, chain(names, repeat(rest)), given)
        by_name: Any = {name: read(name, value) for name, value in named.items()}
        try:
            return function(*placed, **by_name)
        except TypeError:
            _check_fit(function, given, named)
            raise

    return called


def _called(function: Callable[..., object]) -> str:
    """A function as users call it; a class or an instance that is called bears the name of the
    class.
    """
    owner, _, name = function.__qualname__.rpartition(".")
    return owner if name.startswith("__") else name


def _part(names: Sequence[str], given: Sequence[object]) -> str:
    """The name of the part that is declared, if that is what the first argument says."""
    named = (
        [*names[:2]] in (["self", "name"], ["mechanism", "name"])
        and len(given) > 1
        and isinstance(given[1], str)
    )
    return f" {shown(given[1])}" if named else ""


def _check_fit(
    function: Callable[..., object], given: Sequence[object], named: Mapping[str, object]
) -> None:
    """Raise :class:`DeclarationError` for arguments that a function does not take, or lacks."""
    signature = inspect.signature(function)
    try:
        signature.bind(*given, **named)
    except TypeError as error:
        wrong = str(error)
    else:
        return
    each = signature.parameters.values()
    own = [one.name for one in each if one.name not in ("self", "cls")]
    by_name = [one.name for one in each if one.kind is inspect.Parameter.KEYWORD_ONLY]
    beyond = len(given) - (len(each) - len(by_name))
    if by_name and beyond > 0 and "too many positional" in wrong:
        wrong = f"name them: {', '.join(f'{name}=' for name in by_name[:beyond])}"
    space = getattr(given[0], "space", None) if given and len(own) < len(each) else None
    where = "" if not isinstance(space, bool) else "in space " if space else "in a plane "
    raise DeclarationError(
        f"{_called(function)}{_part([*signature.parameters], given)}: {wrong}; {where}it takes"
        f" {', '.join(own) or 'nothing'}"
    ) from None


def _said(hint: Any, scope: dict[str, Any]) -> _Kind | None:
    """The kind that an annotation says, which may be a text in a module."""
    with suppress(NameError, TypeError, AttributeError):  # names that only type checkers see
        return _kind(eval(hint, scope) if isinstance(hint, str) else hint)
    return None


def _kind(hint: Any) -> _Kind | None:
    """The kind that an annotation says; None for one that its function looks at itself."""
    origin, of = typing.get_origin(hint) or hint, typing.get_args(hint)
    if origin is Annotated:
        return _ranged(*of) if isinstance(of[1], Within) else _measured(*of[1:])
    if origin in (typing.Union, types.UnionType):
        return _one_of(of)
    if origin is Literal:
        return _SIMPLE[str] if all(isinstance(one, str) for one in of) else None
    if origin in (Sequence, Iterable, Collection) or (origin is tuple and of[1:] == (...,)):
        return _row(of[0], _NO_NAMES if origin is Collection else _NO_ROWS)
    if origin is np.ndarray:
        return _ARRAYS.get(of[-1])
    if origin is Mapping or origin is dict:
        by_name = of == (str, float)
        words = "values by name, as {'l': 0.25}" if by_name else "a mapping by name"
        return _if(words, lambda value: isinstance(value, Mapping))
    if origin is Callable:
        return _if("a function", callable)
    if not isinstance(origin, type) or origin in _SIMPLE:
        return _SIMPLE.get(origin)
    ours = origin.__module__.startswith("lagrange_casadi")
    if not ours or origin.__name__ in _OWN:
        return None
    article = "an" if origin.__name__[0] in "AEIO" else "a"
    words = getattr(origin, "_known_as", f"{article} {origin.__name__}")
    return _if(words, lambda value: isinstance(value, origin))


def _if(words: str, admits: Callable[[object], bool]) -> _Kind:
    """A kind of which values are taken as they are."""
    return _Kind(words, lambda value: value if admits(value) else None)


def _one_of(hints: Sequence[object]) -> _Kind | None:
    """One of several kinds; None where one of them is looked at by the function."""
    others = [hint for hint in hints if hint is not type(None)]
    found = [kind for hint in others if (kind := _kind(hint))]
    if len(found) < len(others):
        return None
    if _SIMPLE[Path] in found:  # may be a text
        found = [kind for kind in found if kind is not _SIMPLE[str]]
    *words, last = dict.fromkeys(kind.words for kind in found)
    return _Kind(
        f"{', '.join(words)} or {last}" if words else last,
        lambda value: next((got for kind in found if (got := kind.read(value)) is not None), None),
        len(others) < len(hints),
    )


def _ranged(of: type, span: Within) -> _Kind:
    """The kind of numbers in a range."""
    simple = _SIMPLE[float if span.unit else of]

    def read(value: object) -> Any:
        found = number(value, span.unit) if span.unit else simple.read(value)
        return found if found is not None and span.admits(found) else None

    named = {Within(): "a finite number", Within(0.0, above=True): "a positive number"}
    words = named.get(span._replace(unit=""), f"{simple.words}{span.words}")
    return _Kind(words + in_words(span.unit).removeprefix("number") if span.unit else words, read)


def _measured(kind: _Kind | None, unit: str = "") -> _Kind | None:
    """A kind of numbers, or of rows of them, of which some may be texts in a ``unit``."""
    if not (kind and unit):
        return kind
    words = f"{kind.words} [{unit}], or of texts with units"
    return _Kind(words, lambda value: kind.read(in_si(value, unit)))


_NO_TEXTS = (str, Mapping)
_NO_NAMES = (str, bytes, set, frozenset)
_NO_ROWS = (*_NO_NAMES, Mapping)
"""Kinds that are walked over, and are no list: of texts, of names of a mapping, of anything."""


def _row(of: object, never: tuple[type, ...]) -> _Kind | None:
    """The kind of rows of something: of numbers, of names, of parts."""
    if of is float:
        return _Kind("a row of numbers", _line)
    kind = _kind(of)
    if kind is None:
        return None
    return _Kind(
        "a list of texts" if of is str else f"a list, each {kind.words}",
        lambda value: None if (found := _each(value, kind.read, never)) is None else tuple(found),
    )


def _each(value: Any, read: Callable[[Any], Any], never: tuple[type, ...]) -> list[Any] | None:
    """List of what is walked over, each read; None where it is no list, or one is of another
    kind.
    """
    if isinstance(value, Iterable) and not isinstance(value, never):
        with suppress(Exception):  # of a class that is not ours, when it is walked over
            found = [*map(read, value.tolist() if isinstance(value, np.ndarray) else value)]
            return found if all(one is not None for one in found) else None
    return None


def texts(value: object) -> list[str] | None:
    """Texts of a list, an array or what else is walked over; None of anything else, as a text."""
    return _each(value, _SIMPLE[str].read, _NO_TEXTS)


def array(value: object) -> Any:
    """A value as an array of doubles."""
    if isinstance(value, str | bytes | memoryview | Mapping | set | frozenset | ca.SX | ca.MX):
        return None
    with suppress(TypeError, ValueError, OverflowError, RuntimeError, NotImplementedError):
        found = np.asarray(value)
        whole = found.dtype.kind in "iuf" or (
            found.dtype.kind == "O" and all(double(one) is not None for one in found.flat)
        )
        return found.astype(float) if whole else None
    return None


def _line(value: object) -> Any:
    """Numbers of a row."""
    found = array(value)
    return tuple(found.tolist()) if np.ndim(found) == 1 else None


def _line_of_texts(value: Any) -> Any:
    """Numbers of a row in which texts may be, with units of one kind."""
    texts = isinstance(value, list | tuple) and any(isinstance(one, str) for one in value)
    return _line(numbers_in(value)[0] if texts else value)


def _whole(value: object) -> Any:
    return int(value) if isinstance(value, Integral) and not isinstance(value, bool) else None


def _pair(value: object) -> Any:
    """A stress and a number."""
    if isinstance(value, tuple | list) and len(value) == 2 and isinstance(value[0], str):
        value = number(value[0], "Pa"), value[1]
    return found if len(found := _line(value) or ()) == 2 else None


def _wholes(value: object) -> Any:
    """A value as an array of whole numbers."""
    found = array(value)
    if found is None or not (np.abs(found) < 2.0**53).all() or (found != np.rint(found)).any():
        return None
    return found.astype(np.int64)


def _graph(value: object) -> Any:
    found = value if isinstance(value, ca.SX | ca.DM) else double(value)
    return None if found is None else ca.SX(found)


def _symbolic(value: object) -> Any:
    """A scalar expression, a number, or a text of one with its unit, as it is; its size is looked
    at where it is used.
    """
    if isinstance(value, ca.SX):
        return value if value.is_scalar() else None
    if isinstance(value, str):
        return value if typed(value)[1] else None
    return value if type(value) is int else double(value)


def _is_path(value: object) -> bool:
    """Return whether the system could have a file of this name."""
    with suppress(UnicodeEncodeError):
        return (
            isinstance(value, str | os.PathLike)
            and isinstance(name := os.fspath(value), str)
            and name != ""
            and b"\0" not in os.fsencode(name)
        )
    return False


_SIMPLE: dict[type, _Kind] = {
    str: _if("a text", lambda value: isinstance(value, str)),
    bool: _Kind(
        "True or False", lambda value: bool(value) if isinstance(value, bool | np.bool_) else None
    ),
    int: _Kind("a whole number", _whole),
    float: _Kind("a number", double),
    Path: _if("a path", _is_path),
}
_SIMPLE[os.PathLike] = _SIMPLE[Path]
_ARRAYS = {
    np.dtype[np.float64]: _Kind("an array of numbers", array),
    np.dtype[np.int64]: _Kind("an array of whole numbers", _wholes),
}

LATER = None
"""Annotation of an argument that its function checks itself, with a better message."""

Measured: TypeAlias = Annotated[Any, LATER]
"""A number in SI units, or a text with its unit."""

Finite: TypeAlias = Annotated[float, Within()]
"""A number that is not infinite."""

Positive: TypeAlias = Annotated[float, Within(0.0, above=True)]
NotNegative: TypeAlias = Annotated[float, Within(0.0)]
Share: TypeAlias = Annotated[float, Within(0.0, 1.0)]
Count: TypeAlias = Annotated[int, Within(1)]
Index: TypeAlias = Annotated[int, Within(0)]

ThreadCount: TypeAlias = Annotated[int, Within(1, MOST_THREADS)]

Length: TypeAlias = Annotated[Any, Within(0.0, above=True, unit="m")]
"""A positive number [m], or a text with its unit; those below in their units."""

Force: TypeAlias = Annotated[Any, Within(0.0, above=True, unit="N")]
Stress: TypeAlias = Annotated[Any, Within(0.0, above=True, unit="Pa")]
Angle: TypeAlias = Annotated[Any, Within(0.0, above=True, unit="rad")]
Time: TypeAlias = Annotated[Any, Within(0.0, above=True, unit="s")]
Duration: TypeAlias = Annotated[Any, Within(0.0, unit="s")]
Frequency: TypeAlias = Annotated[Any, Within(0.0, above=True, unit="1/s")]
Hours: TypeAlias = Annotated[Any, Within(0.0, above=True, unit="h")]

Elastic: TypeAlias = Annotated[
    tuple[float, float], _Kind("Young's modulus [Pa] and Poisson's ratio", _pair)
]

Numeric: TypeAlias = Annotated[Any, _Kind("a number or an array of numbers", array)]
"""A number, or an array of numbers of any shape."""

Row: TypeAlias = Annotated[Any, _Kind("a row of numbers", _line_of_texts)]
"""Numbers, or texts with units of one kind."""

Symbolic: TypeAlias = Annotated[Any, _Kind("a number, or an expression in parameters", _symbolic)]
"""A number, a text with a unit, or an expression of parameters, for what is declared before there
is a mechanism.
"""

# What is no output is refused by who knows which outputs there are.
Outputs: TypeAlias = Annotated[
    Sequence[str],
    _Kind("a list of texts", lambda value: value if (found := texts(value)) is None else found),
]
"""Names of outputs that are wanted."""

Graph: TypeAlias = Annotated[Any, _Kind("a casadi.SX expression", _graph)]
"""A ``casadi.SX`` expression."""
