"""What certificates read of a scene, without anything that is derived."""

from lagrange_casadi.declare.declared import Declared, equations_of
from lagrange_casadi.equations.model_data import described


def declaration(scene, values):
    """The mechanism in plain numbers and its equations, for values of all parameters by name."""
    p = tuple(values.values())
    return Declared.of(described(scene, values), tuple(equation.at(p) for equation in equations_of(scene.mechanism)))
