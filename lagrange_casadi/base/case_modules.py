"""The files of cases as modules: any process can import them, because their name has the path of
the file.

So dataclasses find the module that they are defined in, and what a case defines can be sent to
another process. Beside its file a case may have modules of its own; they are imported by their
plain names while it is loaded, and anew for every case.
"""

from __future__ import annotations

import importlib
import importlib.util
import os
import sys
import threading
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec, SourceFileLoader
from pathlib import Path
from types import ModuleType

__path__: list[str] = []
"""Package of case files, which :class:`_Finder` finds."""

_FILE = f"{__name__}.file_"
_HELPERS = "__helpers__"
_loading = threading.RLock()
_seen: set[str] = set()
"""The names of the helpers that can be imported now: of one case at a time, lest another one takes
them for its own.
"""

_under_way: list[_Beside] = []


def load(file: Path) -> ModuleType:
    """The module of a case's file, an absolute path, executed anew.

    What it raises passes as it is.
    """
    name = _FILE + os.fsencode(file).hex()
    spec = _spec(name)
    assert spec is not None
    assert spec.loader is not None
    with _loading:
        module, before = importlib.util.module_from_spec(spec), sys.modules.get(name)
        sys.modules[name] = module
        try:
            spec.loader.exec_module(module)
        except BaseException:
            del sys.modules[name]
            if before is not None:
                sys.modules[name] = before
            raise
    return module


@contextmanager
def beside(module: ModuleType) -> Iterator[None]:
    """Let modules that lie beside a case's file be imported by their names; one case at a time."""
    with _loading:
        if _under_way:
            _under_way[-1].note()  # a case may load another one
        helpers = vars(module).setdefault(_HELPERS, {})
        _see(helpers)
        now = _Beside(str(Path(str(module.__file__)).parent), helpers, set(sys.modules))
        _under_way.append(now)
        importlib.invalidate_caches()
        sys.path.insert(0, now.folder)
        try:
            yield
        finally:
            with suppress(ValueError):
                sys.path.remove(now.folder)
            _under_way.pop()
            now.note()
            if _under_way:
                _see(_under_way[-1].helpers)


@dataclass(frozen=True, eq=False)
class _Beside:
    """A folder whose modules may be imported, those that were, and the names of what was imported
    before.
    """

    folder: str
    helpers: dict[str, ModuleType]
    before: set[str]

    def note(self) -> None:
        """Note which modules of the folder were imported."""
        for name in sys.modules.keys() - self.before:
            file = getattr(sys.modules[name], "__file__", None)
            if (
                isinstance(file, str)
                and file.startswith(self.folder + os.sep)
                and not name.startswith(_FILE)
            ):
                self.helpers[name] = sys.modules[name]
        _seen.update(self.helpers)


def _see(helpers: Mapping[str, ModuleType]) -> None:
    """Let these be imported, and no other case's."""
    for name in _seen - helpers.keys():
        sys.modules.pop(name, None)
    sys.modules.update(helpers)
    _seen.clear()
    _seen.update(helpers)


class _Loader(SourceFileLoader):
    def exec_module(self, module: ModuleType) -> None:
        with beside(module):
            super().exec_module(module)


class _Finder(MetaPathFinder):
    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        return _spec(fullname) if fullname.startswith(_FILE) else None


def _spec(name: str) -> ModuleSpec | None:
    file = os.fsdecode(bytes.fromhex(name.removeprefix(_FILE)))
    return importlib.util.spec_from_file_location(name, file, loader=_Loader(name, file))


sys.meta_path.append(_Finder())
