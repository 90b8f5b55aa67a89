"""What tells one sweep from another, in words."""

from dataclasses import replace

import pytest
import sweeps
from internals import Grid, Plan, Request, difference

pytestmark = pytest.mark.quick


def test_another_posture_is_told_with_what_else_a_scene_is(monkeypatch):
    """A scene's fingerprint holds them all, and does not tell one from another."""
    sweeps.use(monkeypatch)
    scene, designs = sweeps.scene(), Grid({"l": [0.2, 0.3]})
    before = Plan.of(scene, designs, Request()).identity
    now = Plan.of(replace(scene, posture={"rod": 0.5}), designs, Request()).identity
    assert difference(before, before) is None
    assert (
        difference(before, now)
        == "an expression, a law of motion or the posture of the scene has changed"
    )


@pytest.mark.parametrize(
    ("before", "now", "says"),
    [
        ({"a": 1, "grid": {"l": "1"}}, {"a": 1, "grid": {"l": "2"}}, "grid l was 1 and is 2"),
        ({"a": [1]}, {"a": None}, "a was [1] and is null"),
        ({"a": 1, "b": 2}, {"a": 1}, "b was there, and is not"),
        ({"sources": "x"}, {"sources": "y"}, "the program's own code has changed"),
    ],
)
def test_the_first_difference_is_told(before, now, says):
    assert difference(before, now) == says
