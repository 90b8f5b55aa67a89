"""What certificates read of a scene, without anything that is derived."""

from lagrange_casadi.declare.declared import Declared
from lagrange_casadi.declare.stated import Stated
from lagrange_casadi.equations.model_data import template


def declaration(scene, values):
    """The mechanism in plain numbers, and what was stated of it, for values of all parameters by
    name.
    """
    return Declared.of(
        template(scene).filled(values),
        Stated.of(scene.mechanism, scene.laws),
        tuple(values.values()),
    )
