"""Identifiers of the package are words of the field: private words that were replaced stay away."""

import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from source import PACKAGE, PATHS, nodes_of

pytestmark = pytest.mark.quick

PRIVATE = {
    *("rungs", "summit", "summits", "look", "looks", "loose", "ball", "balls", "rubbing", "rubs"),
    *("lets", "crew", "errand", "errands", "trail", "trails", "doubts", "doubtful", "misfits"),
    *("borne", "swings", "tally", "witness", "freed", "tells", "reaching", "stations", "spreads"),
    *("told", "untold", "felt", "stead"),
}
"""Words that once stood for methods of evaluation, local maxima, samples, load points and more."""

PUBLIC = frozenset(("Spreads", "spreads", "ball_constraint", "PEAK_NOT_TOLD"))
"""Names that stay: a spread of tolerances as in statistics, an element of URDF, and a status, which
files have as a word.
"""


def names(path: Path) -> Iterator[str]:
    """What a module names: classes, functions, parameters, attributes, keywords and variables."""
    for node in nodes_of(path):
        for field in ("id", "attr", "arg", "name", "asname"):
            if isinstance(name := getattr(node, field, None), str):
                yield name


def words(name: str) -> set[str]:
    return {word.lower() for word in re.split(r"_|(?<=[a-z])(?=[A-Z])", name)}


def test_identifiers_are_in_the_words_of_the_field():
    private = [
        f"{path.relative_to(PACKAGE)}: {name}"
        for path in PATHS
        for name in sorted({path.stem, *names(path)} - PUBLIC)
        if words(name) & PRIVATE
    ]
    assert not private, "\n".join(private)


def test_no_program_tells_or_feels():
    """Docstrings, comments, messages and scripts: a program reports, states, returns."""
    spoken = re.compile(r"\b(told|tells?|telling|felt|feels?)\b(?!\()", re.IGNORECASE)
    found = [
        f"{path.relative_to(PACKAGE)}:{number}: {line.strip()}"
        for path in sorted(PACKAGE.rglob("*.*"))
        if path.suffix in {".py", ".c", ".h", ".js", ".md"}
        for number, line in enumerate(path.read_text().splitlines(), 1)
        if spoken.search(line)
    ]
    assert not found, "\n".join(found)
