"""The text of a small export, word for word; ``pytest tests/test_golden.py --update`` takes over a
change that you have read.
"""

import difflib
import re
from pathlib import Path

import casadi as ca
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


@pytest.mark.parametrize("file", FILES)
def test_the_text_is_as_it_was(file, tmp_path, request):
    export(slider_crank(wanted=["effort", "section:rod"]), tmp_path, name="press")
    found, golden = plainly((tmp_path / file).read_text()), GOLDEN / file
    if request.config.getoption("--update"):
        GOLDEN.mkdir(exist_ok=True)
        golden.write_text(found)
        (GOLDEN / "casadi.txt").write_text(_series())
        pytest.skip(f"took over {file}")
    wanted = golden.read_text()
    if (GOLDEN / "casadi.txt").read_text() != _series():
        # Another CasADi may write the same expressions otherwise; what is around them is ours.
        found, wanted = (_CASADI.sub(r"\1\2", text) for text in (found, wanted))
    lines = difflib.unified_diff(
        wanted.splitlines(), found.splitlines(), f"golden/{file}", file, lineterm=""
    )
    changed = "\n".join(lines)
    assert not changed, (
        f"the exported text has changed; if it should, run with --update:\n{changed}"
    )


def test_the_diff_can_be_read(tmp_path, monkeypatch, request):
    if request.config.getoption("--update"):
        pytest.skip("the golden text is being written")
    golden = (GOLDEN / "press.h").read_text()
    monkeypatch.setattr(f"{__name__}.GOLDEN", tmp_path)
    (tmp_path / "casadi.txt").write_text(_series())
    (tmp_path / "press.h").write_text(golden.replace("[N m]", "[N]"))
    (tmp_path / "out").mkdir()
    with pytest.raises(AssertionError, match=r"\n *-.*\[N\].*\n *\+.*\[N m\]"):
        test_the_text_is_as_it_was("press.h", tmp_path / "out", request)
