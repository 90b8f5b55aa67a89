"""Specs of figures as text in a file, and back."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Sequence
from typing import Any

from ..errors import DeclarationError, StoreError, one_line
from ..store.untrusted import parsed
from .specs import KINDS, Spec


def dump_specs(specs: Sequence[Spec]) -> str:
    """Specs as text, for a file."""
    return json.dumps([{"kind": spec.kind} | dataclasses.asdict(spec) for spec in specs])


def parse_specs(text: str) -> tuple[Spec, ...]:
    """Specs from a file's text; none from an empty one.

    Raises :class:`StoreError` for what are none.
    """
    try:
        return tuple(
            _parse(entry) for entry in parsed(text or "[]", [{"kind": str, "name": str}], "figures")
        )
    except (ValueError, TypeError, KeyError, RecursionError, DeclarationError) as error:
        raise StoreError(f"the file's attribute 'figures' is damaged: {one_line(error)}") from None


def _parse(entry: dict[str, Any]) -> Spec:
    fields: dict[str, Any] = {
        key: tuple(value) if isinstance(value, list) else value
        for key, value in entry.items()
        if key != "kind"
    }
    return KINDS[entry["kind"]](**fields)
