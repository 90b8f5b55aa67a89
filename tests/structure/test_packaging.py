"""Metadata of the package, and the recipe for conda, say the same."""

import re
from importlib.metadata import metadata
from pathlib import Path

import jinja2
import pytest
import yaml

import lagrange_casadi

ROOT = Path(__file__).parents[2]

pytestmark = pytest.mark.quick


def requirements(lines):
    """Names and least versions; conda calls a matplotlib without windows matplotlib-base."""
    plain = (re.sub(r"\s", "", line).replace("matplotlib-base", "matplotlib") for line in lines)
    return {re.sub(r"[-_]", "-", line.lower()) for line in plain}


def test_the_conda_recipe_is_yaml_and_has_the_dependencies_of_the_package():
    text = (ROOT / "recipe" / "meta.yaml").read_text()
    template = jinja2.Template(text, undefined=jinja2.StrictUndefined)
    recipe = yaml.safe_load(template.render(PYTHON="python"))
    about = metadata("lagrange_casadi")
    declared = [line for line in about.get_all("Requires-Dist") if "extra ==" not in line]
    assert recipe["package"]["version"] == lagrange_casadi.__version__
    python = f"python{about['Requires-Python']}"
    assert requirements(recipe["requirements"]["run"]) == requirements([*declared, python])
    assert (ROOT / recipe["about"]["license_file"]).exists()
    (script,) = recipe["build"]["entry_points"]
    assert script == "lagrange-casadi = lagrange_casadi.cli:main"
