"""Efforts of open chains by what others have compiled for this very machine: Pinocchio's headers by
the C++ compiler, and dynibo by Rust's.
"""

from __future__ import annotations

import ctypes
import math
import os
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from lagrange_casadi.engine.codegen import find_compiler

from . import arm_data
from .paper_case import Array, Work

HERE = Path(__file__).parent
DEFINES = (
    "-DBOOST_MPL_LIMIT_LIST_SIZE=30",
    "-DBOOST_MPL_LIMIT_VECTOR_SIZE=30",
    "-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS",
    "-DBOOST_FUSION_INVOKE_MAX_ARITY=12",
)
"""As Pinocchio's own configuration for CMake has them."""

DYNIBO_GRAVITY = 9.80665
"""A constant of dynibo [m/s^2], along -z."""


@dataclass(frozen=True)
class Chain:
    """Revolute joints, each on the link before: turned and placed there, about an own axis 0, 1 or
    2; slender links; gravity.
    """

    axes: Sequence[int]
    turned: Sequence[Array]
    masses: Sequence[float]
    lengths: Sequence[float]
    gravity: Sequence[float]

    @property
    def places(self) -> Array:
        """Places of the joints on the links before, (n, 3)."""
        x = np.array([0.0, *self.lengths[:-1]])
        return np.stack([x, 0 * x, 0 * x], axis=1)

    @property
    def centres(self) -> Array:
        """Centres of mass, (n, 3)."""
        x = np.array(self.lengths) / 2
        return np.stack([x, 0 * x, 0 * x], axis=1)

    @property
    def inertias(self) -> Array:
        """Moments of inertia about these, (n, 3, 3)."""
        moments = np.array(self.masses) * np.array(self.lengths) ** 2 / 12
        found: Array = moments[:, None, None] * np.diag([0.0, 1.0, 1.0])
        return found


def efforts(n: int, t: Array, library: str) -> Work:
    """What works out the efforts of an open chain of uniform links, (n, t)."""
    from .pinocchio_chain import GRAVITY, LENGTH, MASS, motion

    flat = (0.0, -GRAVITY, 0.0)
    chain = Chain([2] * n, [np.eye(3)] * n, [MASS] * n, [LENGTH] * n, flat)
    return LIBRARIES[library](chain, motion(n, t))


def arm_efforts(t: Array, library: str) -> Work:
    """What works out the arm's efforts, (6, t). The first joint turns about the link's own x."""
    axes = [0, *(int(np.argmax(axis)) for axis in arm_data.AXES[1:])]
    turned = [arm_data.UPRIGHT, *[np.eye(3)] * 5]
    chain = Chain(axes, turned, arm_data.MASSES, arm_data.LENGTHS, arm_data.GRAVITY)
    return LIBRARIES[library](chain, arm_data.motion(t))


def _pinocchio(chain: Chain, motion: Sequence[Array]) -> Work:
    library = _built_by_cpp()
    numbers = (chain.turned, chain.places, chain.masses, chain.centres, chain.inertias)
    arrays: list[npt.NDArray[Any]] = [np.ascontiguousarray(chain.axes, np.int32)]
    arrays += [np.ascontiguousarray(array, float) for array in (*numbers, chain.gravity)]
    library.made.restype = ctypes.c_void_p
    made = library.made(len(chain.axes), *map(_pointer, arrays))
    return _loop(library, made, motion, 1.0)


def _dynibo(chain: Chain, motion: Sequence[Array]) -> Work:
    library = _built_by_rust()
    library.made.restype = ctypes.c_void_p
    with tempfile.TemporaryDirectory() as folder:
        urdf = Path(folder) / "chain.urdf"
        urdf.write_text(_urdf(chain))
        made = library.made(os.fsencode(urdf))
    # Where all accelerations are larger by a factor, so are all efforts.
    return _loop(library, made, motion, DYNIBO_GRAVITY / -min(chain.gravity))


LIBRARIES: dict[str, Callable[[Chain, Sequence[Array]], Work]] = {
    "pinocchio": _pinocchio,
    "dynibo": _dynibo,
}


def _loop(library: ctypes.CDLL, made: int, motion: Sequence[Array], factor: float) -> Work:
    """One call for all instants, which are (instants, joints) there; accelerations are multiplied
    by ``factor``, of which the result, the same array at every call, is then a multiple.
    """
    q, v, a = (np.ascontiguousarray(each.T) for each in motion)
    v, a, out = v * math.sqrt(factor), a * factor, np.empty_like(q)
    arguments = [ctypes.c_void_p(made), ctypes.c_long(len(q)), *map(_pointer, (q, v, a, out))]
    kept = (q, v, a)

    def work() -> Array:
        library.efforts(*arguments)
        found: Array = out.T / factor if kept and factor != 1.0 else out.T
        return found

    return work


def _pointer(array: npt.NDArray[Any]) -> ctypes.c_void_p:
    return ctypes.c_void_p(array.ctypes.data)


@cache
def _built_by_cpp() -> ctypes.CDLL:
    import pinocchio

    compiler = find_compiler("c++")
    include = (
        next(p for p in Path(pinocchio.__file__).parents if p.name == "lib").parent / "include"
    )
    if compiler is None or not (include / "eigen3").is_dir():
        raise RuntimeError("needs a C++ compiler, and pip install cmeel-eigen")
    flags = ("-std=c++17", "-O3", "-DNDEBUG", "-march=native", "-w", "-fPIC", "-shared", *DEFINES)
    paths = (f"-I{include}", f"-I{include / 'eigen3'}")
    target = Path(tempfile.mkdtemp()) / "pinocchio_native.so"
    source = HERE / "pinocchio_native.cpp"
    return _made([*compiler.command, *flags, *paths, str(source), "-o", str(target)], target)


@cache
def _built_by_rust() -> ctypes.CDLL:
    cargo = shutil.which("cargo")
    if cargo is None:
        raise RuntimeError("needs Rust's cargo")
    folder = Path(tempfile.mkdtemp())
    shutil.copytree(HERE / "dynibo_loop", folder / "dynibo_loop")
    target = folder / "built" / "release" / "libdynibo_loop.so"
    manifest = str(folder / "dynibo_loop" / "Cargo.toml")
    build = ["build", "-q", "--release", "--target-dir", str(folder / "built")]
    return _made([cargo, *build, "--manifest-path", manifest], target)


def _made(command: Sequence[str], target: Path) -> ctypes.CDLL:
    environment = os.environ | {"RUSTFLAGS": "-C target-cpu=native"}
    found: Any = subprocess.run(command, env=environment, capture_output=True, text=True)
    if found.returncode:
        raise RuntimeError(f"does not build: {found.stderr.strip().splitlines()[:1]}")
    return ctypes.CDLL(str(target))


def _urdf(chain: Chain) -> str:
    """The chain as a file for robots, turned so that its gravity is along -z."""
    upright = np.eye(3)
    if chain.gravity[1]:
        upright = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
    parts, before = ['<robot name="chain"><link name="base"/>'], "base"
    for k, (axis, mass) in enumerate(zip(chain.axes, chain.masses, strict=True)):
        turned, place = np.asarray(chain.turned[k]), chain.places[k]
        if k == 0:
            turned, place = upright @ turned, upright @ place
        angles = (
            math.atan2(turned[2, 1], turned[2, 2]),
            math.asin(-turned[2, 0]),
            math.atan2(turned[1, 0], turned[0, 0]),
        )
        moments = zip(("ixx", "iyy", "izz"), np.diag(chain.inertias[k]).tolist(), strict=True)
        inertia = " ".join(f'{name}="{value!r}"' for name, value in moments)
        parts.append(
            f'<link name="link{k}"><inertial><mass value="{mass!r}"/>'
            f'<origin xyz="{_row(chain.centres[k])}" rpy="0 0 0"/>'
            f'<inertia {inertia} ixy="0" ixz="0" iyz="0"/></inertial></link>'
            f'<joint name="joint{k}" type="continuous"><parent link="{before}"/>'
            f'<child link="link{k}"/><origin xyz="{_row(place)}" rpy="{_row(angles)}"/>'
            f'<axis xyz="{_row(np.eye(3)[axis])}"/></joint>'
        )
        before = f"link{k}"
    return "".join([*parts, "</robot>"])


def _row(numbers: Sequence[float] | Array) -> str:
    return " ".join(repr(float(number)) for number in numbers)
