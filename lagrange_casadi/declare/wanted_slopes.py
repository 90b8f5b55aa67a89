"""Sensitivities among what is wanted: by which parameters the derivatives of all other outputs are wanted too."""

from __future__ import annotations

from collections.abc import Iterable

from ..arguments import texts
from .mechanism import Mechanism

SENSITIVITY = "sensitivity"
"""The kind: alone it is by all parameters, as ``sensitivity:l`` by one. ``all`` is without it."""


def sensitivities(mechanism: Mechanism) -> list[str]:
    """What can be wanted of it by parameter."""
    return [f"{SENSITIVITY}:{name}" for name in mechanism.parameters]


def by_parameters(mechanism: Mechanism, names: Iterable[str]) -> tuple[str, ...]:
    """The parameters by which sensitivities are among wanted names, in the order of declaration."""
    asked = {*(texts(names) or ())}
    return tuple(name for name in mechanism.parameters if asked & {SENSITIVITY, f"{SENSITIVITY}:{name}"})


def others(names: Iterable[str]) -> tuple[str, ...]:
    """The wanted names that are no sensitivity."""
    return tuple(name for name in names if name.partition(":")[0] != SENSITIVITY)
