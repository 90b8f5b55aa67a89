"""Former public names still work, and warn with the name that replaced them."""

import importlib
import inspect
import pkgutil
from types import SimpleNamespace

import pytest
from internals import RENAMED, renamed

import lagrange_casadi
from lagrange_casadi.errors import DeclarationError

pytestmark = pytest.mark.quick


def things(name):
    """Every class or function of the package with a name, commands apart."""
    found = {}
    for module in pkgutil.walk_packages(lagrange_casadi.__path__, "lagrange_casadi."):
        if module.name.endswith("__main__") or module.name.startswith("lagrange_casadi.cli"):
            continue
        thing = vars(importlib.import_module(module.name)).get(name)
        if (inspect.isclass(thing) or inspect.isfunction(thing)) and thing.__module__:
            found[id(inspect.unwrap(thing))] = thing
    return list(found.values())


@pytest.mark.parametrize("entry", RENAMED)
def test_a_former_name_leads_to_the_new_one(entry):
    owner, _, old = entry.partition(".")
    new = RENAMED[entry]
    if entry.endswith(")"):
        check_keyword(entry, new)
    elif owner in ("actuators", "strength"):
        module = importlib.import_module(f"lagrange_casadi.{owner}")
        with pytest.warns(DeprecationWarning, match=f"{old} is deprecated; use {new}"):
            assert getattr(module, old) is getattr(module, new)
        assert new in module.__all__
    else:
        (cls,) = (thing for thing in things(owner) if hasattr(thing, old))
        assert new in {*dir(cls), *inspect.signature(cls).parameters}
        with pytest.warns(DeprecationWarning, match=f"{entry} is deprecated; use {new}"):
            assert vars(cls)[old].fget(SimpleNamespace(**{new: 1})) == 1


def check_keyword(entry, new):
    """The keyword is in the signature, and its former name is not."""
    path, _, old = entry.removesuffix(")").partition("(")
    owner, _, name = path.rpartition(".")
    (found,) = (
        [getattr(things(owner)[0], name)]
        if owner
        else [one for one in things(name) if new in inspect.signature(one).parameters]
    )
    parameters = inspect.signature(found).parameters
    assert new in parameters
    assert old not in parameters
    with pytest.warns(DeprecationWarning, match=f"use {new}="), pytest.raises(DeclarationError):
        found(**{old: 1})  # what else it needs is missing


def test_a_former_keyword_reaches_the_function_under_its_new_name():
    @renamed
    def safety(*, yield_criterion):
        return yield_criterion

    with pytest.warns(DeprecationWarning, match="safety\\(yielding=\\) is deprecated"):
        assert safety(yielding="tresca") == "tresca"
    with pytest.raises(DeclarationError, match="yielding= is the former name of yield_criterion="):
        safety(yielding="tresca", yield_criterion="tresca")


def test_a_module_without_a_name_says_so():
    for name in ("actuators", "strength"):
        with pytest.raises(AttributeError, match="has no attribute 'nothing'"):
            getattr(importlib.import_module(f"lagrange_casadi.{name}"), "nothing")  # noqa: B009
