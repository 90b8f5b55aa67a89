"""What users rely on, as one text each: the public API, helps, files, headers, errors."""

from __future__ import annotations

import importlib
import inspect
import re
import tempfile
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from types import ModuleType
from typing import Any

import every_way
import h5py
import mechanisms
from click import Context
from click.testing import CliRunner

from lagrange_casadi import errors, evaluate, export, save, sweep
from lagrange_casadi.cli import program

MODULES = ("studies.optimise", "studies.sweep")
"""Modules that users import from, beside those that are public names of the package."""


def api() -> Iterator[str]:
    """Names and signatures of functions, and of the public members of classes."""
    root = importlib.import_module("lagrange_casadi")
    modules = [root, *(x for name in root.__all__ if inspect.ismodule(x := getattr(root, name)))]
    modules += [importlib.import_module(f"lagrange_casadi.{name}") for name in MODULES]
    for module in dict.fromkeys(modules):
        for name, thing in sorted(_public(module).items()):
            yield f"{module.__name__}.{name}{_signature(thing)}"
            if inspect.isclass(thing) and not issubclass(thing, BaseException):
                yield from (f"    .{line}" for line in _members(thing))


def _public(module: ModuleType) -> dict[str, Any]:
    names = getattr(module, "__all__", None) or [
        name for name, thing in vars(module).items() if _is_own(thing)
    ]
    return {name: getattr(module, name) for name in names if not name.startswith("_")}


def _is_own(thing: object) -> bool:
    return inspect.isclass(thing) and thing.__module__.startswith("lagrange_casadi")


def _signature(thing: object) -> str:
    """Return the arguments of what is called; the type of what is not, without the module's."""
    if inspect.ismodule(thing):
        return ": module"
    if not callable(thing):
        return f": {type(thing).__name__}"
    if inspect.isclass(thing) and issubclass(thing, BaseException):
        return ": error"
    text = re.sub(r"<(?:factory|[^<>]* at 0x\w+)>", "...", str(inspect.signature(thing)))
    return re.sub(r"(: |-> )'([^']*)'", r"\1\2", text)


def _members(kind: type) -> Iterator[str]:
    """Yield public methods, properties and fields of a class of the package and its parents."""
    own = [one for one in kind.__mro__ if one.__module__.startswith("lagrange_casadi")]
    names = {name for one in own for name in (*vars(one), *getattr(one, "__annotations__", ()))}
    for name in sorted(name for name in names if not name.startswith("_")):
        found = inspect.getattr_static(kind, name, None)
        function = getattr(found, "__func__", found)
        yield f"{name}{_signature(function) if inspect.isfunction(function) else ''}"


def helps() -> Iterator[str]:
    """What ``--help`` of the program and of every command shows."""
    for words in ([], *([name] for name in program.list_commands(Context(program)))):
        asked = [*words, "--help"]
        yield " ".join(["$ lagrange-casadi", *asked])
        shown = CliRunner().invoke(program, asked, prog_name="lagrange-casadi", terminal_width=100)
        yield shown.output


def files() -> Iterator[str]:
    """Datasets and attributes of a run in the plane, one in space, and a sweep."""
    with tempfile.TemporaryDirectory() as folder:
        for name in ("plane", "space"):
            scene = every_way.DECLARED[name]()
            save(evaluate(scene, backend="vm"), Path(folder) / f"{name}.h5")
            yield from _file(Path(folder) / f"{name}.h5")
        scene = mechanisms.slider_crank(wanted=["effort", "section:rod", "reaction:guide"])
        grid, out = {"l": (0.2, 0.3, 2)}, Path(folder) / "sweep.h5"
        sweep(scene, grid, out=out, backend="c", keep="histories", workers=1)
        yield from _file(out)


def _file(path: Path) -> Iterator[str]:
    with h5py.File(path) as file:
        yield f"{path.stem}: {_attributes(file.attrs)}"
        found: dict[str, h5py.Dataset] = {}
        file.visititems(found.__setitem__)
        for name, thing in sorted(found.items()):
            axes = ""
            if isinstance(thing, h5py.Dataset):
                axes = f" {thing.dtype} ({', '.join(_axes(thing))})"
                axes += " checked" if thing.fletcher32 else ""
            yield f"{path.stem}/{name}{axes}: {_attributes(thing.attrs)}"


def _axes(dataset: h5py.Dataset) -> Iterator[str]:
    for dimension in dataset.dims:
        yield next((Path(scale.name).name for scale in dimension.values()), "-")


def _attributes(attributes: Mapping[str, Any]) -> str:
    """Return names of attributes, and the values of those that say what a number means."""
    texts = ("units", "long_name", "sign", "schema", "schema_version", "conventions", "Conventions")
    names = [name for name in attributes if not name.isupper()]  # HDF5's own
    return ", ".join(f"{name}={attributes[name]!s}" if name in texts else name for name in names)


def headers() -> Iterator[str]:
    """Declarations of exported headers, without comments."""
    for name in ("plane", "space"):
        with tempfile.TemporaryDirectory() as folder:
            export(every_way.DECLARED[name](), folder, name=name)
            text = (Path(folder) / f"{name}.h").read_text()
        text = re.sub(r"/\*.*?\*/", "", text, flags=re.DOTALL)
        text = re.sub(r"(#define \w+) .*", r"\1", text)  # of a release, or of a machine
        yield from (line for line in map(str.rstrip, text.splitlines()) if line.strip())


def classes() -> Iterator[str]:
    """Classes of errors: parents, and the status with which the command line ends."""
    for name, kind in sorted(vars(errors).items()):
        if inspect.isclass(kind) and kind.__module__ == errors.__name__:
            parents = ", ".join(parent.__name__ for parent in kind.__bases__)
            yield f"{name}({parents}): exit status {getattr(kind, 'exit_status', '-')}"


TEXTS: dict[str, Callable[[], Iterator[str]]] = {
    "api.txt": api,
    "help.txt": helps,
    "files.txt": files,
    "headers.txt": headers,
    "errors.txt": classes,
}
