"""What certificates read of a scene, without anything that is derived."""

from internals import Declared, Stated


def declaration(scene, solution):
    """The mechanism in plain numbers as a solution has them, and what was stated of it."""
    values = [one["value"] for one in solution.description["parameters"].values()]
    stated = Stated.of(scene.mechanism, scene.laws).at(values)
    return Declared.of(solution.description, stated)
