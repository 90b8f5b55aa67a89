"""The cases that come with the package, by name."""

from __future__ import annotations

from importlib import metadata
from pathlib import Path

_IN_A_CLONE = Path(__file__).parents[1] / "cases"


def shipped_cases() -> dict[str, Path]:
    """Their folders by name: of an installation what its record tells, else those of a clone; none where there are none."""
    recorded = [Path(str(file.locate())) for file in metadata.files("lagrange_casadi") or () if file.match("cases/*/case.py")]
    there = [path.parent for path in recorded if path.is_file()] or [path.parent for path in _IN_A_CLONE.glob("*/case.py")]
    return {folder.name: folder for folder in sorted(there)}
