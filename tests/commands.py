"""Commands as they are typed."""

import shlex

from conftest import CASES

from lagrange_casadi.cli import main


def words(line):
    """The words of a command line; CASE stands for the paper's case."""
    return [str(CASES / "slider_crank") if word == "CASE" else word for word in shlex.split(line)]


def command(line, *more):
    """The status of a command, which further words may follow."""
    return main([*words(line), *map(str, more)])
