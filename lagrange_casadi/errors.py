"""Every exception this package raises on purpose.

A message is one line: it names the offending part, says what was expected and, where there is a
list, what is valid. ``exit_status`` is what the command line returns: 2 for a mistake in what was
asked, 1 for a computation that failed.
"""

from __future__ import annotations

import difflib
import errno
import linecache
import re
import sys
import traceback
import warnings
from collections.abc import Collection, Iterable, Mapping, Sequence
from pickle import PicklingError

_FEW = 40
"""Characters that a list of names takes at most, where there is little room."""

_LONG = 293
"""Characters of names that a message takes at most."""

_MOST = 2000
"""Characters of a message at most, whatever it quotes."""

_SHOWN = 120
"""Characters of a value that a message takes at most."""


_CONTROLS = re.compile(
    "[\x00-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff\ufeff]"
)
"""Characters that a terminal obeys, that turn the direction of writing, and halves of characters,
which cannot be written.
"""


def escaped(text: str) -> str:
    """A text as it may be shown on a terminal: control characters, ends of lines too, as Python
    writes them.
    """
    return _CONTROLS.sub(lambda found: found[0].encode("unicode_escape").decode(), text)


def one_line(error: BaseException) -> str:
    """Message of an error in one line that may be shown; empty if the error cannot say it."""
    try:
        return _line(str(error))
    except Exception:  # of a class that is not ours
        return ""


def _line(text: str) -> str:
    """A text in one line, the middle left out where it quotes too much."""
    text = escaped(" ".join(text.split()))
    return text if len(text) <= _MOST else f"{text[: _MOST // 2]} ... {text[-_MOST // 2 :]}"


def check_kind(what: str, value: object, expected: str, *kinds: type) -> None:
    """Raise :class:`DeclarationError` for a value of none of the kinds, which says what was
    ``expected``.
    """
    if not isinstance(value, kinds):
        raise DeclarationError(f"{what}: expected {expected}, got {shown(value)}")


def shown(value: object) -> str:
    """A value in a message: as Python writes it, in one line that is not long."""
    try:
        text = " ".join(repr(value).split())
    except Exception:  # of a class that is not ours, and of whole numbers with thousands of digits
        text = f"a {type(value).__name__}"
    return text if len(text) <= _SHOWN else f"{text[: _SHOWN - 3]}..."


def listed(names: Iterable[str], empty: str = "none", room: int = _FEW) -> str:
    """Names with commas between: as many as there is room for, and how many more there are."""
    left = list(names)
    begun = [left.pop(0)] if left else []
    while left and len(", ".join([*begun, left[0]])) <= room:
        begun.append(left.pop(0))
    return (", ".join(begun) or empty) + (f" and {len(left)} more" if left else "")


def warn(words: str, category: type[Warning] = UserWarning) -> None:
    """Warn of something: at the line of the user's that led to it, however many functions of this
    package are between.
    """
    frame, level = sys._getframe(1), 2
    while frame.f_back and frame.f_globals.get("__name__", "").partition(".")[0] == __package__:
        frame, level = frame.f_back, level + 1
    warnings.warn(words, category, stacklevel=level)


def lacking(error: OSError) -> bool:
    """Return whether the system lacks something for now: descriptors, processes, memory.

    Nothing is wrong with what was asked.
    """
    return error.errno in (errno.EMFILE, errno.ENFILE, errno.EAGAIN, errno.ENOMEM)


class LagrangeCasadiError(Exception):
    """Base of all errors of this package: one line that names the part, says what was expected, and
    lists what is valid.

    ``exit_status`` is that of the command line: 2 for a mistake in what was asked, 1 for a
    computation that failed. ``placement`` shows the mechanism where something is wrong with its
    places: see :class:`.Placement`.
    """

    exit_status = 2
    placement: object = None

    def __init_subclass__(cls, exit_status: int | None = None) -> None:
        cls.exit_status = exit_status or cls.exit_status

    def __reduce__(self) -> tuple[object, ...]:
        """Sent to another process, it goes without its placement and its scene, whose mechanism
        lives here.
        """
        left = {
            name: value for name, value in vars(self).items() if name not in ("placement", "scene")
        }
        return type(self).__new__, (type(self), *self.args), left

    def __str__(self) -> str:
        return _line(Exception.__str__(self))  # that of KeyError has quotation marks

    def _render_traceback_(self) -> list[str]:
        """Lines that a notebook shows: that of the cell which led here, and the message."""
        cells = [
            f"line {n}: {escaped(linecache.getline(frame.f_code.co_filename, n).strip())}"
            for frame, n in traceback.walk_tb(self.__traceback__)
            if frame.f_globals.get("__name__") == "__main__"
        ]
        return [*cells[-1:], f"{type(self).__name__}: {self}"]


class DeclarationError(LagrangeCasadiError):
    """A mechanism, a motion or a scene is declared in a way that has no meaning."""


class UnknownNameError(DeclarationError, KeyError):
    """A name that nothing bears, or several; the message lists the names that exist, or the nearest
    of many and what lists all.

    ``place`` is where they stand, as in a file.
    """

    def __init__(
        self,
        kind: str,
        name: str | Sequence[str],
        valid: Iterable[str],
        listed_by: str = "",
        place: str = "",
    ) -> None:
        several = isinstance(name, (list, tuple)) and all(isinstance(other, str) for other in name)
        names, unknown = list(valid), list(dict.fromkeys(name)) if several else [str(name)]
        many = len(", ".join(names)) > _LONG
        room = _LONG - len(", ") if many else _LONG
        valid_names = f"valid: {listed(names, 'none are declared', room)}"
        if many and listed_by:
            valid_names = f"{listed_by} lists the {len(names)} there are"
        unknown_names = ", ".join(f"'{other}'{_hint(other, names, many)}" for other in unknown)
        super().__init__(
            f"{f'{place}: ' if place else ''}unknown {kind}{'s' if len(unknown) > 1 else ''}"
            f" {unknown_names}; {valid_names}"
        )


def check_known(
    kind: str, names: Iterable[str], valid: Collection[str], listed_by: str = "", place: str = ""
) -> None:
    """Raise :class:`UnknownNameError` for those of the names that are not valid."""
    if unknown := [str(name) for name in names if name not in valid]:
        raise UnknownNameError(kind, unknown, valid, listed_by, place)


class NoComponentError(UnknownNameError, AttributeError):
    """A component that there is in space alone."""


def _hint(name: str, names: Sequence[str], many: bool) -> str:
    """The nearest of names, in words; of those that are too many to be listed else one that holds
    it.
    """
    held = [other for other in names if name and name in other] if many else []
    close = [*difflib.get_close_matches(name, names, n=1), *held]
    return f" (did you mean '{close[0]}'?)" if close else ""


class NoAttributeError(UnknownNameError, AttributeError):
    """An attribute that an object of this package does not have."""


class ParameterError(LagrangeCasadiError):
    """A parameter's value is not a number, is out of its range, or makes a part impossible."""


class PickleError(LagrangeCasadiError, PicklingError):
    """An object cannot be sent to another process; the message says what can be sent instead."""


class NumberError(DeclarationError, ValueError):
    """A value is no number in its unit: neither a finite number, nor a text of one with a unit,
    such as ``350 deg`` or ``100 mm``.
    """


class PostureError(DeclarationError):
    """A posture that does not determine how loops are assembled.

    ``assembly_modes`` are those of each loop that has several, as entries of a posture;
    ``lacking`` is true if other loops need rough values to begin an iteration. ``scene`` is the
    scene for which the posture was tried, if known.
    """

    scene: object = None

    def __init__(
        self,
        message: str,
        assembly_modes: Sequence[tuple[Mapping[str, float], ...]] = (),
        lacking: bool = False,
    ):
        super().__init__(message)
        self.assembly_modes, self.lacking = tuple(assembly_modes), lacking


class MobilityError(DeclarationError):
    """The number of drives does not fit the degrees of freedom; these were counted where the
    mechanism was ``assembled``, if it can be.
    """

    assembled: bool = True


class CaseError(LagrangeCasadiError):
    """A case's file is missing, raises, or has no ``scene``."""


class ModelFileError(LagrangeCasadiError):
    """A model file of another program cannot be read; the message names file, line and element."""


class AssemblyError(LagrangeCasadiError, exit_status=1):
    """A loop cannot be closed, or is singular, at some instant ``t`` of the motion [s], None at its
    start.
    """

    t: float | None = None


class CompilerError(LagrangeCasadiError, exit_status=1):
    """No compiler where one is required, or the compiler refused the emitted C."""


class PathError(LagrangeCasadiError):
    """A file is not where it is said to be, or cannot be put where it is wanted."""


class StoreError(LagrangeCasadiError, exit_status=1):
    """Writing a result file failed, or a file is not a whole one of this schema."""


class SizeError(LagrangeCasadiError, exit_status=1):
    """A result does not fit into memory."""


class NoDesignError(LagrangeCasadiError, exit_status=1):
    """No design of a sweep is what is looked for."""


class AccuracyError(LagrangeCasadiError, exit_status=1):
    """No way to evaluate reaches a wanted accuracy."""


class BusyError(LagrangeCasadiError, exit_status=1):
    """Another process is writing the same file."""


class ClusterError(LagrangeCasadiError, exit_status=1):
    """A scheduler cannot be reached or was lost, or its workers cannot do what they are sent."""


class MissingPackageError(LagrangeCasadiError, ImportError, exit_status=1):
    """A package of this installation is not there, and what was asked for needs it."""


class CertificateError(LagrangeCasadiError, exit_status=1):
    """A result fails the independent checks that come with it."""


class CertificateWarning(UserWarning):
    """A solution fails the independent checks that come with it: it is given, and marked."""


class StoppedError(LagrangeCasadiError, exit_status=130):
    """A command was stopped from outside, by Ctrl-C or a signal; finished parts are kept."""
