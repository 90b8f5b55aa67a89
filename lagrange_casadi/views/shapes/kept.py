"""Specs of figures as text in a file, and back."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Sequence
from typing import Any

from ...errors import DeclarationError
from ...results.store.untrusted import parsed
from .specs import KINDS, Spec


def dump_specs(specs: Sequence[Spec]) -> str:
    """Specs as text, for a file."""
    return json.dumps([{"kind": spec.kind} | dataclasses.asdict(spec) for spec in specs])


def parse_specs(text: str) -> tuple[Spec, ...]:
    """Specs from a file's text; none from an empty one.

    Raises ``ValueError`` for others.
    """
    return tuple(map(_parse, parsed(text or "[]", [{"kind": str, "name": str}], "figures")))


def _parse(entry: dict[str, Any]) -> Spec:
    fields: dict[str, Any] = {
        key: tuple(value) if isinstance(value, list) else value for key, value in entry.items()
    }
    kind = fields.pop("kind")
    if kind not in KINDS:
        raise ValueError(f"figures: unknown kind {kind!r}; valid: {', '.join(KINDS)}")
    try:
        return KINDS[kind](**fields)
    except DeclarationError as error:
        raise ValueError(f"figures: {error}") from None
