"""Arguments of public functions, looked at in one place: numbers, texts with a unit, counts, and
the kinds that signatures name.
"""

from __future__ import annotations

import functools
import inspect
import math
import os
import sys
import types
import typing
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple, ParamSpec, TypeAlias, TypeVar

import casadi as ca
import numpy as np

from ..errors import DeclarationError, shown
from .space import MOST_THREADS
from .units import Within, double, is_whole, typed

LATER = "looked at where it is used"
"""Annotation of an argument that its function checks itself, with a better message."""

_OWN = ("Body", "Point", "Joint", "Link", "Density", "Beam")
"""Parts of mechanisms: declarations look at these themselves, for they list what is valid."""

Finite: TypeAlias = Annotated[float, Within()]
"""A number that is not infinite."""

Positive: TypeAlias = Annotated[float, Within(0.0, above=True)]
NotNegative: TypeAlias = Annotated[float, Within(0.0)]
Share: TypeAlias = Annotated[float, Within(0.0, 1.0)]
Count: TypeAlias = Annotated[int, Within(1)]
Index: TypeAlias = Annotated[int, Within(0)]

ThreadCount: TypeAlias = Annotated[int, Within(1, MOST_THREADS)]

Elastic: TypeAlias = Annotated[tuple[float, float], "elastic"]
"""Young's modulus and Poisson's ratio."""

Numeric: TypeAlias = Annotated[Any, "numeric"]
"""A number, or an array of numbers of any shape."""

Symbolic: TypeAlias = Annotated[Any, "symbolic"]
"""A number, a text with a unit, or an expression of parameters, for what is declared before there
is a mechanism.
"""

Outputs: TypeAlias = Annotated[Sequence[str], "outputs"]
"""Names of outputs that are wanted."""

Graph: TypeAlias = Annotated[Any, "graph"]
"""A ``casadi.SX`` expression."""

Thing = TypeVar("Thing", bound=Callable[..., Any])
_P = ParamSpec("_P")
_Result = TypeVar("_Result")


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
    """A kind of values, in words; ``read`` makes of one what the function takes, and ``_NONE`` of
    what is of another kind.
    """

    words: str
    read: Callable[[Any], Any]


_NONE: Any = object()


@dataclass(frozen=True)
class _Asked:
    """Arguments that a function asks for: its ``signature``, the ``kinds`` that are known, and a
    key that shows that a call fits.

    ``positional`` are the names of arguments that may be given by their place; there are none if
    some of its arguments are not of these two simple sorts.
    """

    signature: inspect.Signature
    kinds: Mapping[str, _Kind]
    positional: tuple[str, ...]
    defaults: Mapping[str, object]
    required: frozenset[str]

    @functools.cached_property
    def placed(self) -> tuple[tuple[int, str, _Kind, object], ...]:
        """Place, name, kind and default of each argument of a kind that may be given by its
        place.
        """
        return tuple(
            (k, name, self.kinds[name], self.defaults[name])
            for k, name in enumerate(self.positional)
            if name in self.kinds
        )

    @functools.cached_property
    def fewest(self) -> float:
        """Number of arguments that a call without names gives at least."""
        lacking = [k for k, name in enumerate(self.defaults, 1) if name in self.required]
        named = self.required.difference(self.positional)
        return math.inf if named or not self.defaults else max(lacking, default=0)

    @classmethod
    def of(cls, signature: inspect.Signature, kinds: Mapping[str, _Kind]) -> _Asked:
        """Make them of a signature."""
        each = signature.parameters.values()
        by_place, by_name = inspect.Parameter.POSITIONAL_OR_KEYWORD, inspect.Parameter.KEYWORD_ONLY
        simple = all(one.kind in (by_place, by_name) for one in each)
        return cls(
            signature,
            kinds,
            tuple(one.name for one in each if one.kind is by_place) if simple else (),
            {one.name: one.default for one in each} if simple else {},
            frozenset(one.name for one in each if one.default is one.empty),
        )

    def fits(self, given: Sequence[object], named: Mapping[str, object]) -> bool:
        """Return whether arguments are all that a function needs, each once."""
        if not named:
            return self.fewest <= len(given) <= len(self.positional)
        if len(given) > len(self.positional) or not self.defaults:
            return False
        placed = self.positional[: len(given)]
        return (
            self.defaults.keys() >= named.keys()
            and named.keys().isdisjoint(placed)
            and self.required.difference(placed) <= named.keys()
        )


def _looking(function: Callable[_P, _Result], kinds: bool = True) -> Callable[_P, _Result]:
    """A function that looks at its arguments before it runs: whether they
    fit, and at their kinds.
    """

    @functools.cache
    def asked() -> _Asked:  # a module's names are not all there when it is read
        signature = inspect.signature(function)
        return _Asked.of(signature, _kinds(function, signature) if kinds else {})

    @functools.wraps(function)
    def called(*given: _P.args, **named: _P.kwargs) -> _Result:
        expected = asked()
        signature, known = expected.signature, expected.kinds

        def read(kind: _Kind, name: str, value: object) -> Any:
            found = kind.read(value)
            if found is _NONE:
                what = f"{_called(function)}{_part(signature, given)}: {name}"
                raise DeclarationError(f"{what}: expected {kind.words}, got {shown(value)}")
            return found

        # Most calls fit, which is seen without binding them: that takes longer than all the rest.
        if expected.fits(given, named):
            for name, each in named.items():
                if (kind := known.get(name)) and each is not expected.defaults[name]:
                    named[name] = read(kind, name, each)
            placed: Any = list(given)
            for k, name, kind, default in expected.placed:
                if k < len(placed) and placed[k] is not default:
                    placed[k] = read(kind, name, placed[k])
            return function(*placed, **named)
        try:
            bound = signature.bind(*given, **named)
        except TypeError as wrong:
            raise DeclarationError(_not_taken(function, signature, given, str(wrong))) from None
        bound_arguments = bound.arguments
        for name, kind in known.items():
            if (
                name not in bound_arguments
                or (value := bound_arguments[name]) is signature.parameters[name].default
            ):
                continue
            if signature.parameters[name].kind is inspect.Parameter.VAR_POSITIONAL:
                bound_arguments[name] = tuple(read(kind, name, each) for each in value)
            elif signature.parameters[name].kind is inspect.Parameter.VAR_KEYWORD:
                bound_arguments[name] = {key: read(kind, key, each) for key, each in value.items()}
            else:
                bound_arguments[name] = read(kind, name, value)
        return function(*bound.args, **bound.kwargs)

    return called


def _called(function: Callable[..., object]) -> str:
    """A function as users call it; a class or an instance that is called bears the name of the
    class.
    """
    owner, _, name = function.__qualname__.rpartition(".")
    return owner if name.startswith("__") else name


def _part(signature: inspect.Signature, given: tuple[object, ...]) -> str:
    """The name of the part that is declared, if that is what the first argument says."""
    named = (
        list(signature.parameters)[:2] in (["self", "name"], ["mechanism", "name"])
        and len(given) > 1
        and isinstance(given[1], str)
    )
    return f" {shown(given[1])}" if named else ""


def _not_taken(
    function: Callable[..., object],
    signature: inspect.Signature,
    given: tuple[object, ...],
    wrong: str,
) -> str:
    """Describe missing or superfluous arguments of a call."""
    each = list(signature.parameters.values())
    own = [one.name for one in each if one.name not in ("self", "cls")]
    named = [one.name for one in each if one.kind is inspect.Parameter.KEYWORD_ONLY]
    beyond = len(given) - (len(each) - len(named))
    if named and beyond > 0 and "too many positional" in wrong:
        wrong = f"name them: {', '.join(f'{name}=' for name in named[:beyond])}"
    space = getattr(given[0], "space", None) if given and len(own) < len(each) else None
    where = "" if not isinstance(space, bool) else "in space " if space else "in a plane "
    return (
        f"{_called(function)}{_part(signature, given)}: {wrong}; {where}it takes"
        f" {', '.join(own) or 'nothing'}"
    )


def _kinds(function: Callable[..., object], signature: inspect.Signature) -> dict[str, _Kind]:
    """The kinds of a function's arguments, of those whose annotation says one."""
    scope = vars(sys.modules[function.__module__])
    found: dict[str, _Kind] = {}
    for name, parameter in signature.parameters.items():
        hint = parameter.annotation
        with suppress(NameError, TypeError, AttributeError):  # names that only type checkers see
            hint = eval(hint, scope) if isinstance(hint, str) else hint
            if hint is not inspect.Parameter.empty and (kind := _kind(hint)):
                found[name] = kind
    return found


def _kind(hint: Any) -> _Kind | None:
    """The kind that an annotation says; None for one that its function looks at itself."""
    origin, of = typing.get_origin(hint) or hint, typing.get_args(hint)
    if origin is Annotated:
        return (
            None if of[1] == LATER else _ranged(*of) if isinstance(of[1], Within) else _NAMED[of[1]]
        )
    if origin in (typing.Union, types.UnionType):
        return _one_of(of)
    if origin is Literal:
        return _SIMPLE[str] if all(isinstance(one, str) for one in of) else None
    if hint in (None, type(None)):
        return _if("None", lambda value: value is None)
    if isinstance(origin, type) and origin in _SIMPLE:
        return _SIMPLE[origin]
    if origin in (Sequence, Iterable, Collection) or (origin is tuple and of[1:] == (...,)):
        return _row(of[0], named=origin is Collection)
    if origin is np.ndarray:
        return _ARRAYS.get(of[-1])
    if origin is Mapping or origin is dict:
        by_name = of == (str, float)
        words = "values by name, as {'l': 0.25}" if by_name else "a mapping by name"
        return _if(words, lambda value: isinstance(value, Mapping))
    if origin is Callable:
        return _if("a function", callable)
    ours = isinstance(origin, type) and origin.__module__.startswith("lagrange_casadi")
    if not ours or origin.__name__ in _OWN or getattr(origin, "_is_protocol", False):
        return None
    article = "an" if origin.__name__[0] in "AEIO" else "a"
    words = getattr(origin, "_known_as", f"{article} {origin.__name__}")
    return _if(words, lambda value: isinstance(value, origin))


def _if(words: str, admits: Callable[[object], bool]) -> _Kind:
    """A kind of which values are taken as they are."""
    return _Kind(words, lambda value: value if admits(value) else _NONE)


def _one_of(hints: tuple[object, ...]) -> _Kind | None:
    """One of several kinds; None where one of them is looked at by the function."""
    found = [kind for hint in hints if (kind := _kind(hint))]
    if len(found) < len(hints):
        return None
    if _SIMPLE[Path] in found:  # may be a text
        found = [kind for kind in found if kind is not _SIMPLE[str]]
    words = list(dict.fromkeys(kind.words for kind in found if kind.words != "None")) or ["None"]
    listed = f"{', '.join(words[:-1])} or {words[-1]}" if len(words) > 1 else words[0]
    return _Kind(
        listed,
        lambda value: next(
            (got for kind in found if (got := kind.read(value)) is not _NONE), _NONE
        ),
    )


def _ranged(of: type, span: Within) -> _Kind:
    """The kind of numbers in a range."""
    simple = _SIMPLE[of]

    def read(value: object) -> Any:
        found = simple.read(value)
        return found if found is not _NONE and span.admits(found) else _NONE

    sign = "positive " if span == Within(0.0, above=True) else "finite " if span == Within() else ""
    return _Kind(f"a {sign}{simple.words.removeprefix('a ')}{'' if sign else span.words}", read)


def _row(of: object, named: bool = False) -> _Kind | None:
    """The kind of rows of something: of numbers, of names, of parts; or the names of a mapping,
    where no order is asked for.
    """
    if of is float:
        return _Kind(
            "a row of numbers",
            lambda value: tuple(found.tolist()) if np.ndim(found := _array(value)) == 1 else _NONE,
        )
    kind = _SIMPLE[str] if of is str else _kind(of)
    if kind is None:
        return None

    def read(value: object) -> object:
        if isinstance(value, str | bytes | set | frozenset) or not isinstance(value, Iterable):
            return _NONE
        if isinstance(value, Mapping) and not named:
            return _NONE
        with suppress(Exception):  # of a class that is not ours, when it is walked over
            found = [
                kind.read(one)
                for one in (value.tolist() if isinstance(value, np.ndarray) else value)
            ]
            return tuple(found) if all(one is not _NONE for one in found) else _NONE
        return _NONE

    return _Kind("a list of texts" if of is str else f"a list, each {kind.words}", read)


def _array(value: object) -> Any:
    """A value as an array of doubles."""
    if isinstance(value, str | bytes | memoryview | Mapping | set | frozenset | ca.SX | ca.MX):
        return _NONE
    with suppress(TypeError, ValueError, OverflowError, RuntimeError, NotImplementedError):
        found = np.asarray(value)
        whole = found.dtype.kind in "iuf" or (
            found.dtype.kind == "O" and all(double(one) is not None for one in found.flat)
        )
        return found.astype(float) if whole else _NONE
    return _NONE


def _pair(value: object) -> Any:
    """Two numbers."""
    found = _array(value)
    return tuple(found.tolist()) if found is not _NONE and found.shape == (2,) else _NONE


def _wholes(value: object) -> Any:
    """A value as an array of whole numbers."""
    found = _array(value)
    whole = (
        found is not _NONE
        and (np.abs(found) < 2.0**53).all()
        and np.array_equal(found, np.rint(found))
    )
    return found.astype(np.int64) if whole else _NONE


def texts(value: object) -> list[str] | None:
    """Texts of a list, an array or what else is walked over; None of anything else, as a text."""
    if isinstance(value, Iterable) and not isinstance(value, str | Mapping):
        with suppress(Exception):  # of a class that is not ours, when it is walked over
            found = value.tolist() if isinstance(value, np.ndarray) else list(value)
            return found if all(isinstance(one, str) for one in found) else None
    return None


def _graph(value: object) -> Any:
    if isinstance(value, ca.SX | ca.DM):
        return ca.SX(value)
    return _NONE if (found := double(value)) is None else ca.SX(found)


def _symbolic(value: object) -> Any:
    """A scalar expression, a number, or a text of one with its unit, as it is; its size is looked
    at where it is used.
    """
    if isinstance(value, ca.SX):
        return value if value.is_scalar() else _NONE
    if isinstance(value, str):
        return value if typed(value)[1] else _NONE
    found = double(value)
    return _NONE if found is None else value if isinstance(value, int | float) else found


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
        "True or False", lambda value: bool(value) if isinstance(value, bool | np.bool_) else _NONE
    ),
    int: _Kind("a whole number", lambda value: int(value) if is_whole(value) else _NONE),
    float: _Kind("a number", lambda value: _NONE if (found := double(value)) is None else found),
    Path: _if("a path", _is_path),
}
_SIMPLE[os.PathLike] = _SIMPLE[Path]
_ARRAYS = {
    np.dtype[np.float64]: _Kind("an array of numbers", _array),
    np.dtype[np.int64]: _Kind("an array of whole numbers", _wholes),
}
_NAMED = {
    "elastic": _Kind("Young's modulus [Pa] and Poisson's ratio", _pair),
    "numeric": _Kind("a number or an array of numbers", _array),
    "symbolic": _Kind("a number, or an expression in parameters", _symbolic),
    # What is no output is refused by who knows which outputs there are.
    "outputs": _Kind(
        "a list of texts", lambda value: value if (found := texts(value)) is None else found
    ),
    "graph": _Kind("a casadi.SX expression", _graph),
}
