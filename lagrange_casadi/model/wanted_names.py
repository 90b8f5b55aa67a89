"""Names of outputs that are wanted: the parts that they are of, the parameters of sensitivities,
and names that are refused.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence

from ..base.arguments import texts
from ..errors import DeclarationError

SENSITIVITY = "sensitivity"
"""The kind: alone it is by all parameters, as ``sensitivity:l`` by one. ``all`` is without it."""


def by_parameters(parameters: Iterable[str], names: Iterable[str]) -> tuple[str, ...]:
    """Choose the parameters by which sensitivities are among wanted names, in the order of
    declaration.
    """
    asked = {*(texts(names) or ())}
    return tuple(name for name in parameters if asked & {SENSITIVITY, f"{SENSITIVITY}:{name}"})


def others(names: Iterable[str]) -> tuple[str, ...]:
    """The wanted names that are no sensitivity."""
    return tuple(name for name in names if name.partition(":")[0] != SENSITIVITY)


def among(kind: str, parts: Iterable[str], names: Collection[str]) -> list[str]:
    """Choose of parts those of which a kind of output is among wanted names."""
    return [part for part in parts if not {"all", kind, f"{kind}:{part}"}.isdisjoint(names)]


def without_fitted(fitted: Iterable[str], names: Sequence[str], what: str) -> None:
    """Raise :class:`.DeclarationError` where the safety of a ``fitted`` joint's pin or bearing is
    among wanted names.
    """
    for joint in fitted:
        if f"safety:{joint}" in (texts(names) or ()):
            raise DeclarationError(
                f"output 'safety:{joint}': {what} have no strength of pins and bearings; want"
                f" reaction:{joint}"
            )


def without_life(names: Sequence[str], what: str) -> None:
    """Raise :class:`.DeclarationError` if a life is among wanted names of a study that evaluates
    single instants.
    """
    for name in texts(names) or ():
        if name.partition(":")[0] == "life":
            raise DeclarationError(
                f"output '{name}': {what} have instants, but a life needs a whole cycle; use"
                " evaluate"
            )
