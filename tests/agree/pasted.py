"""Python to paste of a scene that a function declares: its calls of the package are written down as
they are made.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from types import ModuleType
from typing import Any
from unittest import mock

import casadi as ca
import numpy as np

import lagrange_casadi

_SIGNS = {"add": "+", "sub": "-", "mul": "*", "truediv": "/", "pow": "**"}
_HEAD = """import casadi as ca
import lagrange_casadi
from lagrange_casadi import Mechanism, Scene, SpatialMechanism, density, motion
"""


class Pasted:
    """A value of the package, and the Python that makes the value after ``lines``.

    Calls of a value that ``is_kept`` become lines: they change the mechanism, and keep their order.
    """

    def __init__(self, value: Any, text: str, lines: list[str], is_kept: bool) -> None:
        self.value, self.text, self.lines, self.is_kept = value, text, lines, is_kept

    def __getattr__(self, name: str) -> Any:
        return self._of(getattr(self.value, name), f"{self.text}.{name}")

    def __call__(self, *given: Any, **named: Any) -> Any:
        words = [self._text(one) for one in given]
        words += [f"{name}={self._text(one)}" for name, one in named.items()]
        made = self.value(*map(_bare, given), **{name: _bare(one) for name, one in named.items()})
        text = f"{self.text}({', '.join(words)})"
        if self.is_kept:
            self.lines.append(f"v{len(self.lines)} = {text}")
            text = f"v{len(self.lines) - 1}"
        return self._of(made, text)

    def __iter__(self):
        return iter(
            [self._of(one, f"{self.text}[{k}]") for k, one in enumerate(_items(self.value))]
        )

    def __getitem__(self, key: Any) -> Any:
        return self._of(self.value[_bare(key)], f"{self.text}[{self._text(key)}]")

    def __neg__(self) -> Any:
        return self._of(-self.value, f"(-{self.text})")

    def _of(self, value: Any, text: str) -> Any:
        if isinstance(value, str | int | float) or value is None:
            return value
        kept = self.is_kept or (isinstance(value, type) and value in _KEPT)
        return Pasted(value, text, self.lines, kept)

    def _text(self, one: Any) -> str:
        """Return an argument in Python."""
        if isinstance(one, Pasted):
            return one.text
        if isinstance(one, dict):
            return f"{{{', '.join(f'{key!r}: {self._text(x)}' for key, x in one.items())}}}"
        if isinstance(one, tuple | list | np.ndarray):
            return f"({''.join(f'{self._text(x)}, ' for x in one)})"
        if callable(one):
            return f"lambda x: {self._text(one(Pasted(ca.SX.sym('x'), 'x', [], False)))}"
        return repr(one.item() if isinstance(one, np.generic) else one)


_KEPT = (lagrange_casadi.Mechanism, lagrange_casadi.SpatialMechanism)


def _binary(name: str, sign: str) -> None:
    def forward(self: Pasted, other: Any) -> Any:
        value = getattr(operator, name)(self.value, _bare(other))
        return self._of(value, f"({self.text} {sign} {self._text(other)})")

    def backward(self: Pasted, other: Any) -> Any:
        value = getattr(operator, name)(_bare(other), self.value)
        return self._of(value, f"({self._text(other)} {sign} {self.text})")

    setattr(Pasted, f"__{name}__", forward)
    setattr(Pasted, f"__r{name}__", backward)


for _name, _sign in _SIGNS.items():
    _binary(_name, _sign)


def _items(value: Any) -> list[Any]:
    """Return the components of a value that is iterated over; CasADi's vectors have rows."""
    return [value[k] for k in range(value.numel())] if isinstance(value, ca.SX) else list(value)


def _bare(one: Any) -> Any:
    """Return an argument without its texts."""
    if isinstance(one, Pasted):
        return one.value
    if isinstance(one, dict):
        return {key: _bare(x) for key, x in one.items()}
    if isinstance(one, tuple | list):
        return type(one)(map(_bare, one))
    return (lambda x: _bare(one(x))) if callable(one) else one


def paste(module: ModuleType, declare: Callable[[], Any]) -> str:
    """Return Python that makes ``scene`` as ``declare()`` does, by calls in ``module``."""
    lines: list[str] = []
    names = ("Mechanism", "SpatialMechanism", "Scene", "density", "motion", "ca")
    told = {
        name: Pasted(getattr(module, name), name, lines, getattr(module, name) in _KEPT)
        for name in names
        if hasattr(module, name)
    }
    with mock.patch.multiple(module, **told):
        scene = declare()
    return "\n".join([_HEAD, *lines, f"scene = {scene.text}", ""])
