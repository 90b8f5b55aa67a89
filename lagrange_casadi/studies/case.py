"""Cases: a folder with a ``case.py``, or a Python file, whose function ``scene()`` returns a
:class:`.Scene`.

One that comes with the package is known by its name alone.

A case may also have ``figures()``, which returns how it wants to be drawn, see :mod:`.figures`, and
modules of its own beside its file.
"""

from __future__ import annotations

import importlib
import os
import sys
import threading
import traceback
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from importlib.machinery import SourceFileLoader
from pathlib import Path
from types import ModuleType
from typing import TypeVar

from ..base.arguments import public
from ..base.shipped_cases import shipped_cases
from ..errors import CaseError, LagrangeCasadiError, shown
from ..model.mistakes import error_text
from ..model.scene import Scene
from ..results.store.specs import Spec, dump_specs, parse_specs

_Result = TypeVar("_Result")

_loading = threading.RLock()
"""Held while a case is loaded: one at a time, but for those that this one loads."""

_under_way: list[tuple[Path, set[str]]] = []
"""Folders of the cases that are being loaded, each by the one before, with the packages that were
imported before.
"""


@dataclass(frozen=True, eq=False)
class Case:
    """A case, loaded: its scene, and the drawings it wants, empty for the usual ones."""

    path: Path
    scene: Scene
    figures: Sequence[Spec]

    def __repr__(self) -> str:
        return f"<Case {self.name}: {self.scene!r}>"

    @property
    def name(self) -> str:
        """The name of its folder, or of its file without the ending."""
        return name_of(self.path)

    def __reduce__(self) -> tuple[Callable[[Path], Case], tuple[Path]]:
        """Sent to another process, a case is loaded there from its file."""
        return load_case, (self.path,)


def name_of(file: Path) -> str:
    """The name of the case of a file."""
    return file.parent.name if file.name == "case.py" else file.stem


def reference(case: Case, folder: Path) -> str:
    """Path of a case from a folder, or the name of one that comes with the package."""
    place = case.path.parent if case.path.name == "case.py" else case.path
    shipped = shipped_cases().get(case.name)
    if shipped and shipped.resolve() == place:
        return case.name
    return Path(os.path.relpath(place, folder.resolve())).as_posix()


@public
def load_case(path: str | os.PathLike[str]) -> Case:
    """Load a case.

    Parameters
    ----------
    path
        A case's folder or Python file, or the name of a case that comes with the package. A folder
        or file of that name has precedence.

    Returns
    -------
    Case
        The case with its scene.

    Raises
    ------
    CaseError
        If the file is missing, fails, or has no ``scene``. Errors of a declaration pass unchanged.
    """
    given = Path(path)
    file = case_file(given)
    if file.suffix != ".py":
        raise CaseError(
            f"case {given}: expected a folder with a case.py, or a Python file ending in .py"
        )
    file = file.resolve()
    with _beside(file.parent):
        module = _guard(given, file, lambda: _executed(file))
        scene = _call(given, file, module, "scene")
        drawn = callable(getattr(module, "figures", None))
        figures = _call(given, file, module, "figures") if drawn else ()
    if not isinstance(scene, Scene):
        raise CaseError(
            f"case {given}: scene() returned {type(scene).__name__}, expected a"
            " lagrange_casadi.Scene"
        )
    if not isinstance(figures, (list, tuple)) or not all(
        isinstance(spec, Spec) for spec in figures
    ):
        raise CaseError(
            f"case {given}: figures() must return a list of specs of lagrange_casadi.figures, got"
            f" {shown(figures)}"
        )
    for spec in figures:
        try:
            parse_specs(dump_specs([spec]))
        except (TypeError, ValueError, RecursionError) as error:
            raise CaseError(
                f"case {given}: figures(): figure {shown(spec.name)} cannot be kept in a file:"
                f" {error_text(error)}"
            ) from None
    return Case(file, scene, tuple(figures))


def declared(file: Path, error: BaseException, kind: type[_Result]) -> _Result | None:
    """The last object of a kind that a case had before an error of :func:`load_case`: that of the
    innermost function of its file that had one, else of the file, else what its function
    ``mechanism()`` or ``scene()`` returns. None where there is none.
    """
    raised = [one for one in (error, error.__cause__) if one]
    frames = [frame for one in raised for frame, _ in traceback.walk_tb(one.__traceback__)]
    own = [frame.f_locals for frame in frames if frame.f_code.co_filename == str(file)]
    module = vars(sys.modules.get(f"case {file}", sys))
    for names in (*reversed(own), module):
        for value in reversed(names.values()):
            if isinstance(value, kind):
                return value
    for name in ("mechanism", "scene"):
        with suppress(Exception), _beside(file.parent):
            if isinstance(made := module[name](), kind):
                return made
    return None


def scene_of(given: Scene | Case) -> Scene:
    """Return the scene that a user hands over, or that of a case."""
    return given.scene if isinstance(given, Case) else given


def case_file(given: Path) -> Path:
    """The file of a case: see :func:`load_case`."""
    try:
        file = given / "case.py" if given.is_dir() else given
        there = file.is_file()
    except OSError as error:
        raise CaseError(f"case {given}: {error.strerror}") from None
    if there:
        return file
    expected = "expected a folder with a case.py, or a Python file"
    if file != given:
        raise CaseError(f"case {given}: has no case.py; {expected}")
    shipped = shipped_cases()
    if str(given) in shipped:
        return shipped[str(given)] / "case.py"
    names = f", or one that comes with the package: {', '.join(shipped)}" if shipped else ""
    raise CaseError(f"case {given}: no such file; {expected}{names}")


def _call(given: Path, file: Path, module: ModuleType, name: str) -> object:
    function = getattr(module, name, None)
    if not callable(function):
        raise CaseError(
            f"case {given}: has no function {name}(); a case's returns a lagrange_casadi.Scene of a"
            " Mechanism, the motion of its driven joints and the instants"
        )
    return _guard(given, file, function)


@contextmanager
def _beside(folder: Path) -> Iterator[None]:
    """Let modules in a case's folder be imported by their names. They are forgotten then: another
    case has its own.
    """
    with _loading:
        outer = _forgotten(*_under_way[-1]) if _under_way else {}
        _under_way.append((folder, set(map(_package, [*sys.modules]))))
        importlib.invalidate_caches()
        sys.path.insert(0, str(folder))
        try:
            yield
        finally:
            with suppress(ValueError):  # a case may have changed the path
                sys.path.remove(str(folder))
            _forgotten(*_under_way.pop())
            sys.modules.update(outer)


def _forgotten(folder: Path, before: set[str]) -> dict[str, ModuleType]:
    """Modules that were imported from a folder, by name, after they are forgotten."""
    own = {
        package
        for package in {*map(_package, [*sys.modules])} - before
        if (folder / package).is_dir() or (folder / f"{package}.py").is_file()
    }
    return {name: sys.modules.pop(name) for name in [*sys.modules] if _package(name) in own}


def _package(name: str) -> str:
    return name.partition(".")[0]


def _executed(file: Path) -> ModuleType:
    """The module of a case's file. Dataclasses look up where they are defined: it has a name."""
    loader = SourceFileLoader(f"case {file}", str(file))
    module = sys.modules[loader.name] = ModuleType(loader.name)
    module.__file__ = str(file)
    loader.exec_module(module)
    return module


def _guard(given: Path, file: Path, action: Callable[[], _Result]) -> _Result:
    """Run a piece of the case; what it raises becomes one line that names the case's own line."""
    try:
        return action()
    except (LagrangeCasadiError, KeyboardInterrupt):
        raise
    except BaseException as error:
        lines = [
            frame.lineno
            for frame in traceback.extract_tb(error.__traceback__)
            if frame.filename == str(file)
        ]
        if isinstance(error, SyntaxError):
            lines = [error.lineno]
        where = f", line {lines[-1]}" if lines and lines[-1] else ""
        raise CaseError(f"case {given}{where}: {error_text(error)}") from error
