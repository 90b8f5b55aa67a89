"""What certificates read of a scene beside its numbers, without anything that is derived."""

from internals import Stated


def declaration(scene, solution):
    """What was stated of the mechanism of a solution."""
    return Stated.of(scene.mechanism, scene.laws).at([*solution.description.values.values()])
