"""A scene's compiled C, loaded."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from ..errors import CompilerError
from .compiler import Compiler, build
from .emit import ENTRY

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Library:
    """The loaded library of one scene graph. Its call releases the interpreter and allocates nothing."""

    path: Path
    entry: Any

    def evaluate(self, t: Array, p: Array, z: Array, out: Array, status: npt.NDArray[np.int32]) -> None:
        """Fill ``out`` (columns, n) and ``status`` (n) for the instants ``t`` (n); ``z`` is the guess, and moves along."""
        n = t.size
        assert out.shape[1:] == status.shape == (n,)
        assert out.flags.c_contiguous
        self.entry(n, *(array.ctypes.data for array in (t, p, z, out, status)))


def load(source: str, compiler: Compiler) -> Library:
    """Build a source, or take it from the cache, and load it. Raises :class:`CompilerError`."""
    path = build(source, compiler)
    try:
        entry = getattr(ctypes.CDLL(str(path)), ENTRY)
    except (OSError, AttributeError):
        path.unlink(missing_ok=True)
        path = build(source, compiler)
        try:
            entry = getattr(ctypes.CDLL(str(path)), ENTRY)
        except (OSError, AttributeError) as error:
            raise CompilerError(f"the library built by {' '.join(compiler.command)} does not load: {error}") from None
    entry.restype = None
    entry.argtypes = [ctypes.c_longlong, *[ctypes.c_void_p] * 5]
    return Library(path, entry)
