"""A name for all that a scene's graphs are derived from, the same in every process."""

from __future__ import annotations

import dataclasses
import functools
import hashlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np

from ..base.scalars import column
from ..base.symbolic import symbolic
from ..model.scene import Scene, Wanted


@symbolic
def fingerprint(scene: Scene, wanted: Wanted) -> str | None:
    """The hash of the declaration, its expressions, laws of motion, what is wanted, and the code
    that derives.

    None if the declaration holds something whose content cannot be known.
    """
    declared = declaration(scene, wanted)
    if declared is None:
        return None
    return hashlib.sha256(
        "\0".join([sources(), ca.CasadiMeta.version(), declared]).encode()
    ).hexdigest()[:32]


@symbolic
def declaration(scene: Scene, wanted: Wanted) -> str | None:
    """All that is declared and wanted, as text; None if it holds something whose content cannot
    be known.
    """
    mechanism = scene.mechanism
    expressions: list[Any] = []
    words: list[str] = []
    content = [
        type(mechanism).__qualname__,
        vars(mechanism),
        mechanism.gravity,
        mechanism.symbols,
        scene.span,
        scene.posture,
        scene.assembly,
        wanted,
        list(scene.laws),
    ]
    content += [scene.weights] if scene.weights is not None else []
    content += [scene.elastic] if scene.elastic else []
    try:
        _spell(content, words, expressions)
    except _UnreadableError:
        return None
    laws = scene.prescribed.motion
    if any(f.class_name() in _UNKNOWN for f in [laws, *laws.find_functions()]):
        return None
    written = ca.densify(column(ca.vec(ca.densify(e)) for e in expressions))
    declared = ca.Function("declared", ca.symvar(written), [written])
    if any(f.class_name() in _UNKNOWN for f in declared.find_functions()):
        return None
    return "\0".join([*words, declared.serialize(), laws.serialize()])


_UNKNOWN = ("CallbackInternal", "External", "GenericExternal")
"""Functions that CasADi writes down by name, not by content."""


class _UnreadableError(Exception):
    pass


def _spell(item: object, words: list[str], expressions: list[ca.SX]) -> None:
    """Add what an object is made of, to the last bit, in an order that its declaration fixes."""
    if item is None or isinstance(item, (str, bool, int)):
        words.append(f"{type(item).__name__} {item!r}")
    elif isinstance(item, (float, np.floating)):
        words.append(float(item).hex())
    elif isinstance(item, ca.SX):
        words.append(f"expression {item.shape}")
        expressions.append(item)
    elif isinstance(item, Mapping):
        words.append(f"mapping {len(item)}")
        for key, value in item.items():
            _spell(key, words, expressions)
            _spell(value, words, expressions)
    elif isinstance(item, (set, frozenset)) and all(isinstance(name, str) for name in item):
        words += [f"set {len(item)}", *sorted(item)]
    elif isinstance(item, (tuple, list)):
        words.append(f"sequence {len(item)}")
        for value in item:
            _spell(value, words, expressions)
    elif dataclasses.is_dataclass(item) and not isinstance(item, type):
        words.append(type(item).__qualname__)
        for entry in dataclasses.fields(item):
            words.append(entry.name)
            _spell(getattr(item, entry.name), words, expressions)
    else:
        raise _UnreadableError


@functools.cache
def sources() -> str:
    """The hash of this package's own sources: another version may derive other graphs."""
    digest = hashlib.sha256()
    root = Path(__file__).parents[1]
    for path in sorted(root.rglob("*.py")):
        digest.update(f"{path.relative_to(root)}\0".encode() + path.read_bytes())
    return digest.hexdigest()
