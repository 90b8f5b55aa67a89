"""The cases that come with the package, by name."""

from __future__ import annotations

from importlib import metadata
from pathlib import Path

_IN_A_CLONE = Path(__file__).parents[2] / "cases"


def shipped_cases() -> dict[str, Path]:
    """Folders of the shipped cases by name: a clone's own, else those in the installation's record;
    none if there are none.

    An installation that runs from a clone has copies of its cases too, as they were when it was
    installed.
    """
    there = [path.parent for path in _IN_A_CLONE.glob("*/case.py")]
    if not there or not (_IN_A_CLONE.parent / "pyproject.toml").is_file():
        recorded = [
            Path(str(file.locate()))
            for file in metadata.files("lagrange_casadi") or ()
            if file.match("cases/*/case.py")
        ]
        there = [path.parent for path in recorded if path.is_file()] or there
    return {folder.name: folder for folder in sorted(there)}
