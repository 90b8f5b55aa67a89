"""The machines that the page on them declares."""

from __future__ import annotations

import contextlib
import functools
import io
import re
from dataclasses import replace

from conftest import CASES

PAGE = CASES.parent / "docs" / "machines.md"


@functools.cache
def shown(title):
    """What the page declares under a heading, by name."""
    _, _, part = PAGE.read_text().partition(f"## {title}\n")
    (block,) = re.findall(r"```python\n(.*?)```", part.partition("\n## ")[0], re.DOTALL)
    names = {}
    with contextlib.redirect_stdout(io.StringIO()):
        exec(compile(block, title, "exec"), names)
    return names


def elsewhere():
    """A planetary gear that rolls, driven at its sun and at its planet's pin."""
    return replace(shown("Planetary gear")["scene"], drives={"main": 1.0, "pin": 2.0})


SCENES = {
    title.replace(" ", "_").lower(): (lambda title=title: shown(title)["scene"])
    for title in ("V-twin", "Scissor lift", "Toggle press", "Cam", "SCARA", "Planetary gear", "Geneva drive")
} | {"planetary_gear_elsewhere": elsewhere}
