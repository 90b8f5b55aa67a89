"""Docstrings begin with a verb or a noun, as PEP 257 asks."""

import ast
import inspect
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType

import pytest
from internals import deflection
from source import PACKAGE, PATHS, nodes_of

import lagrange_casadi
from lagrange_casadi import (
    actuators,
    animation,
    beams,
    bearings,
    density,
    elements,
    figures,
    forward,
    motion,
    peaks,
    strength,
)

FIRST = {"What", "Whether", "Of", "Those", "How", "Where", "Why", "Which", "Its", "Their", "Theirs"}
FIRST |= {"From", "That", "Whatever", "Whoever"}
"""First words of a sentence without a subject."""


def docstrings(path: Path) -> Iterator[ast.Constant]:
    """Docstrings of modules, classes and functions, and texts that stand below an assignment."""
    for node in nodes_of(path):
        body = getattr(node, "body", None)
        for entry in body if isinstance(body, list) else []:
            match entry:
                case ast.Expr(value=ast.Constant(value=str()) as found):
                    yield found


@pytest.mark.quick
def test_docstrings_begin_with_a_verb_or_a_noun():
    begun = []
    for path in PATHS:
        for found in docstrings(path):
            words = found.value.split()
            if words[0] in FIRST or words[:2] == ["The", "same"]:
                begun.append(f"{path.relative_to(PACKAGE)}:{found.lineno}: {' '.join(words[:6])}")
    assert not begun, "\n".join(begun)


@pytest.mark.quick
def test_modules_that_docstrings_name_are_there():
    """Sphinx looks for none of them, for they are no part of the interface."""
    names = {"." + ".".join(p.relative_to(PACKAGE).with_suffix("").parts) for p in PATHS}
    gone = [
        f"{path.relative_to(PACKAGE)}: {found}"
        for path in PATHS
        for found in re.findall(r":mod:`\.+([a-z_.]+)`", path.read_text())
        if not any(f"{name}.".endswith((f".{found}.", f".{found}.__init__.")) for name in names)
    ]
    assert not gone, "\n".join(gone)


def functions(*doors: ModuleType) -> Iterator[Callable[..., object]]:
    """Public functions of modules that users import from."""
    for door in doors:
        for name in door.__all__:
            if inspect.isfunction(thing := getattr(door, name)):
                yield thing


def described(function: Callable[..., object]) -> set[str]:
    """Arguments that a docstring describes; it has sections of numpydoc, one of them for what the
    function gives.
    """
    text = inspect.getdoc(function)
    sections = re.split(r"^(\w+)\n-+$", text, flags=re.MULTILINE)
    found = dict(zip(sections[1::2], sections[2::2], strict=True))
    assert found.keys() <= {"Parameters", "Returns", "Yields", "Raises", "Notes"}
    given = inspect.signature(function).return_annotation
    assert ({"Returns", "Yields"} & found.keys()) or given == "None"
    entries = re.findall(r"^(\S.*)$", found["Parameters"], flags=re.MULTILINE)
    named = [line.partition(" : ")[0] for line in entries]
    return {one.lstrip("*") for line in named for one in line.split(", ")}


FACADE = tuple(functions(lagrange_casadi))
MODULES = (actuators, animation, beams, bearings, density, elements, figures, forward, motion)
MODULES += (peaks, strength)
FUNCTIONS = (*FACADE, *functions(*MODULES), deflection)


@pytest.mark.quick
@pytest.mark.parametrize("function", FUNCTIONS, ids=lambda one: f"{one.__module__}.{one.__name__}")
def test_a_public_function_says_what_it_takes_and_gives(function):
    """Its docstring has numpydoc's sections, and describes each of its arguments."""
    assert described(function) == {*inspect.signature(function).parameters}
    assert function not in FACADE or "\nRaises\n---" in inspect.getdoc(function)


def classes(door: ModuleType) -> Iterator[type]:
    """Public classes of a module that users import from."""
    yield from filter(inspect.isclass, (getattr(door, name) for name in door.__all__))


CLASSES = {thing: None for door in (lagrange_casadi, *MODULES) for thing in classes(door)}


def methods(*classes: type) -> Iterator[Callable[..., object]]:
    """Public methods that classes themselves define and that take arguments."""
    for one in classes:
        for name, thing in vars(one).items():
            function = getattr(thing, "__func__", thing)
            public = name[0] != "_" and inspect.isfunction(function)
            if public and len(inspect.signature(function).parameters) > 1:
                yield function


@pytest.mark.quick
@pytest.mark.parametrize("method", methods(*CLASSES), ids=lambda one: one.__qualname__)
def test_a_public_method_says_what_it_takes_and_gives(method):
    """Its docstring has numpydoc's sections, or names the function of the same arguments that has
    them.
    """
    signature, text = inspect.signature(method), inspect.getdoc(method)
    if named := re.search(r"see\s:func:`\.(?:\w+\.)*(\w+)`\.?$", text.partition("\n\n")[0]):
        (function,) = (one for one in FUNCTIONS if one.__name__ == named[1])
        assert described(function) >= {*signature.parameters} - {"self"}
    else:
        assert described(method) == {*signature.parameters} - {"self", "cls"}
