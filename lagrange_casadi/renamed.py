"""Former public names: each still works, and warns with the name that replaced it."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping
from typing import Any, ParamSpec, TypeVar, cast

from .errors import DeclarationError, PostureError, warn

Thing = TypeVar("Thing", bound=Callable[..., Any])
_P = ParamSpec("_P")
_Result = TypeVar("_Result")

RENAMED: Mapping[str, str] = {
    "CamProfile.told_undercut": "undercut_summary",
    "Column.yielding": "yield_moment",
    "Elasticity.told": "completed",
    "Holding.untold": "reason",
    "Measurement.rung": "method",
    "Mechanism.own": "ownership",
    "Motion.demands": "parameter_constraints",
    "Motion.told": "description",
    "Motor.at_most": "short_time_torque",
    "Motor.lasting": "continuous_torque",
    "PostureError.ways": "assembly_modes",
    "Provenance.rung": "method",
    "Safety.is_open": "not_evaluated",
    "Scene.demands": "parameter_constraints",
    "Scene.giving": "with_elastic",
    "Shape.demands": "parameter_constraints",
    "Solution.held": "holding",
    "Solution.left_open": "indeterminate",
    "Solution.safety(yielding)": "yield_criterion",
    "Sweep.seen": "verified",
    "Vibration.untold": "reason",
    "actuators.judge": "assess",
    "duty_of(held)": "holding",
    "refine_safety(yielding)": "yield_criterion",
    "safety(yielding)": "yield_criterion",
    "size(yielding)": "yield_criterion",
    "strength.Swing": "StressCycle",
}
"""New names of attributes, of keywords of functions and methods, and of names in modules."""


def renamed(thing: Thing) -> Thing:
    """Let a class answer the former names of its attributes and of keywords of its methods, or a
    function take former names of its keywords, by :data:`RENAMED`.
    """
    name = thing.__name__
    if not isinstance(thing, type):
        return cast(Thing, _taking(name, thing))
    for entry, new in RENAMED.items():
        owner, _, old = entry.partition(".")
        if owner == name and old.endswith(")"):
            method = old.partition("(")[0]
            setattr(thing, method, _taking(f"{name}.{method}", getattr(thing, method)))
        elif owner == name:
            setattr(thing, old, _attribute(entry, new))
    return cast(Thing, thing)


def former(module: str, names: Mapping[str, object], name: str) -> object:
    """Return what a module, with its ``names``, calls otherwise today; for its ``__getattr__``.

    Raises :class:`AttributeError` for a name that it never had.
    """
    entry = f"{module.rpartition('.')[2]}.{name}"
    if entry not in RENAMED:
        raise AttributeError(f"module '{module}' has no attribute '{name}'")
    _warn(entry, RENAMED[entry])
    return names[RENAMED[entry]]


def _attribute(entry: str, new: str) -> property:
    def read(self: object) -> object:
        _warn(entry, new)
        return getattr(self, new)

    return property(read, doc=f"Deprecated name of ``{new}``.")


def _taking(name: str, function: Callable[_P, _Result]) -> Callable[_P, _Result]:
    """Return a function that takes its former keywords too."""
    keywords = {
        entry[len(name) + 1 : -1]: new
        for entry, new in RENAMED.items()
        if entry.startswith(f"{name}(")
    }

    @functools.wraps(function)
    def called(*given: _P.args, **named: _P.kwargs) -> _Result:
        for old, new in keywords.items():
            if old not in named:
                continue
            if new in named:
                raise DeclarationError(f"{name}: {old}= is the former name of {new}=; give one")
            _warn(f"{name}({old}=)", f"{new}=")
            named[new] = named.pop(old)
        return function(*given, **named)

    return called


def _warn(old: str, new: str) -> None:
    warn(f"{old} is deprecated; use {new}", DeprecationWarning)


renamed(PostureError)  # errors come before this module
