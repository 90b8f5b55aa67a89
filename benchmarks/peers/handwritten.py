"""The closed form in C, written by hand: scalar, with the flags of the package's own C, and as far
as a compiler vectorises it.
"""

from __future__ import annotations

import ctypes
from functools import cache
from pathlib import Path

import numpy as np

from lagrange_casadi.engine.codegen.compiler import find_compiler, loaded

from .paper_case import Array, SliderCrank, Work

SOURCE = Path(__file__).with_name("slider_crank.c")
COLUMNS = 40


SCALAR = ("-fno-tree-vectorize",)
"""gcc 12 vectorises at -O2 what is as regular as this; a scalar code it is only without."""


@cache
def library(flags: tuple[str, ...]) -> ctypes.CDLL:
    """The compiled source, loaded, with flags after the package's.

    Raises :class:`RuntimeError` where there is no C compiler.
    """
    compiler = find_compiler()
    if compiler is None:
        raise RuntimeError("the handwritten peer needs a C compiler")
    return loaded(SOURCE.read_text(), compiler, ("-fvisibility=default", *flags))


def instants(case: SliderCrank, t: Array, flags: tuple[str, ...] = SCALAR) -> Work:
    """What fills the package's columns of ``wanted="all"``, (columns, t); the array is the same at
    every call.
    """
    entry = library(flags).slider_crank_instants
    times, parameters, out = _flat(t), _flat(case.parameters), np.empty((COLUMNS, len(t)))
    return _caller(entry, (len(t),), times, parameters, out)


def designs(case: SliderCrank, t: Array, lengths: Array, flags: tuple[str, ...] = SCALAR) -> Work:
    """The same for one length of the rod after another; what is left is the last one's."""
    parameters, out = _flat(case.parameters), np.empty((COLUMNS, len(t)))
    call = _caller(library(flags).slider_crank_instants, (len(t),), _flat(t), parameters, out)

    def work() -> Array:
        for length in lengths:
            parameters[1] = length
            call()
        return out

    return work


def sections(case: SliderCrank, t: Array, xi: Array, flags: tuple[str, ...] = SCALAR) -> Work:
    """What fills axial, shear and bending of the rod, (3, t, xi); the array is the same at every
    call.
    """
    entry = library(flags).slider_crank_sections
    times, parameters, ratios, out = (
        _flat(t),
        _flat(case.parameters),
        _flat(xi),
        np.empty((3, len(t), len(xi))),
    )
    return _caller(entry, (len(t), len(xi)), times, parameters, ratios, out)


def _flat(values: Array | tuple[float, ...]) -> Array:
    return np.ascontiguousarray(values, dtype=np.float64)


def _caller(entry: ctypes._NamedFuncPointer, sizes: tuple[int, ...], *arrays: Array) -> Work:
    """A call with every argument ready; the last array is the result, and the arrays live as long
    as the call.
    """
    entry.restype = None
    entry.argtypes = [ctypes.c_longlong] * len(sizes) + [ctypes.c_void_p] * len(arrays)
    pointers = [array.ctypes.data for array in arrays]

    def call() -> Array:
        entry(*sizes, *pointers)
        return arrays[-1]

    return call
