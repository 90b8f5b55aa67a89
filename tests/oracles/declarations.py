"""What certificates read of a scene, without anything that is derived."""

from internals import Declared, Stated, template


def declaration(scene, values):
    """The mechanism in plain numbers, and what was stated of it, for values of all parameters by
    name.
    """
    return Declared.of(
        template(scene).filled(values),
        Stated.of(scene.mechanism, scene.laws),
        tuple(values.values()),
    )
