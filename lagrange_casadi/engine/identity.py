"""Identity of all that a scene's graphs are derived from, the same in every process."""

from __future__ import annotations

import functools
from pathlib import Path

import casadi as ca

from ..base.arrays import Json
from ..base.files import digest
from ..base.scalars import column
from ..base.symbolic import symbolic
from ..base.templates import dumps
from ..model.scene import Scene, Wanted

_UNKNOWN = ("CallbackInternal", "External", "GenericExternal")
"""Functions that CasADi writes down by name, not by content."""


@symbolic
def identity_of(scene: Scene, wanted: Wanted) -> str | None:
    """Return the hash of the declaration, the wanted outputs, and the code that derives; None if
    the declaration holds something whose content cannot be known.
    """
    declared = declaration(scene, wanted)
    if declared is None:
        return None
    return digest("\0".join([sources(), ca.CasadiMeta.version(), declared]).encode())[:32]


@symbolic
def declaration(scene: Scene, wanted: Wanted) -> str | None:
    """Return all that is declared and wanted, as text, to the last bit; None if it holds something
    whose content cannot be known.
    """
    mechanism, laws = scene.mechanism, scene.prescribed.motion
    expressions: list[ca.SX] = []

    def expression(leaf: object) -> Json:
        if not isinstance(leaf, ca.SX):
            raise TypeError
        expressions.append(ca.vec(ca.densify(leaf)))
        return {"expression": leaf.shape}

    # What was asked for has expressions among its keys, which differ from process to process.
    parts = vars(mechanism) | {
        "measures": [*mechanism.measures.asked.values()],
        "asked": [*mechanism.asked.values()],
    }
    content = (
        (type(mechanism).__qualname__, parts, mechanism.gravity, mechanism.symbols),
        (scene.span, scene.posture, scene.assembly, wanted, list(scene.laws)),
        (scene.weights, scene.elastic),
    )
    try:
        words = dumps(content, expression)
    except TypeError:
        return None
    written = ca.densify(column(expressions))
    declared = ca.Function("declared", ca.symvar(written), [written])
    if any(f.class_name() in _UNKNOWN for g in (laws, declared) for f in [g, *g.find_functions()]):
        return None
    return "\0".join([words, declared.serialize(), laws.serialize()])


@functools.cache
def sources() -> str:
    """Return the hash of this package's own sources: another version may derive other graphs."""
    root = Path(__file__).parents[1]
    paths = sorted(root.rglob("*.py"))
    return digest(*(f"{path.relative_to(root)}\0".encode() + path.read_bytes() for path in paths))
