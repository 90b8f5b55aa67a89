"""Texts that others read, as they were: a small export word for word, and the contract with users.

``pytest tests/structure --update`` takes over a change that you have read: it writes the text, and
prints the difference.
"""

import difflib
import re
from pathlib import Path

import casadi as ca
import contract
import pytest
from mechanisms import slider_crank

from lagrange_casadi import __version__, export

pytestmark = pytest.mark.quick

GOLDEN = Path(__file__).parent / "golden"
FILES = ("press.h", "press.c", "CMakeLists.txt", "example.c", "README.md")
_CASADI = re.compile(
    r"(/\* ---- Written by CasADi ).*?(/\* ---- Written by lagrange_casadi)", re.DOTALL
)


def _series():
    """The release series of CasADi."""
    return ".".join(ca.CasadiMeta.version().split(".")[:2]) + "\n"


def plainly(text):
    """Without what every release changes: versions, and the hash that CasADi's own writing of
    expressions goes into.
    """
    text = text.replace(__version__, "<version>").replace(ca.CasadiMeta.version(), "<casadi>")
    return re.sub(
        r"\b[0-9a-f]{32}\b", "<scene>", re.sub(r"SEAL 0x[0-9a-f]{8}u", "SEAL <seal>", text)
    )


def changed(file, found):
    """The difference of a text from the golden one."""
    wanted = (GOLDEN / file).read_text() if (GOLDEN / file).exists() else ""
    if (GOLDEN / "casadi.txt").read_text() != _series():
        # Another CasADi may write the same expressions otherwise; what is around them is ours.
        found, wanted = (_CASADI.sub(r"\1\2", text) for text in (found, wanted))
    golden, found = wanted.splitlines(), found.splitlines()
    return "\n".join(difflib.unified_diff(golden, found, f"golden/{file}", file, lineterm=""))


@pytest.fixture(scope="module")
def press(tmp_path_factory):
    folder = tmp_path_factory.mktemp("press")
    export(slider_crank(wanted=["effort", "section:rod"]), folder, name="press")
    return folder


@pytest.mark.parametrize("file", [*FILES, *contract.TEXTS])
def test_the_text_is_as_it_was(file, press, request):
    lines = contract.TEXTS.get(file)
    found = plainly("\n".join(lines()) + "\n" if lines else (press / file).read_text())
    change = changed(file, found)
    if request.config.getoption("--update"):
        (GOLDEN / file).write_text(found)
        (GOLDEN / "casadi.txt").write_text(_series())
        with request.config.pluginmanager.getplugin("capturemanager").global_and_fixture_disabled():
            print(change)
        return
    assert not change, f"the text has changed; if it should, run with --update:\n{change}"
