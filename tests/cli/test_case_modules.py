"""Cases are modules: helpers beside the file, other processes; and one case does not see another's
helpers. Whatever a case raises is one line.
"""

import copy
import pickle
import sys
from concurrent.futures import ThreadPoolExecutor

import pytest
from commands import python

from lagrange_casadi import load_case
from lagrange_casadi.errors import CaseError, PickleError

HEAD = """
from __future__ import annotations
from dataclasses import KW_ONLY, dataclass
from typing import ClassVar
from lagrange_casadi import Mechanism, Scene, load_case, motion

@dataclass(frozen=True)
class Size:
    unit: ClassVar[str] = "m"
    _: KW_ONLY
    length: float = 0.5

def arm(length):
    m = Mechanism("arm")
    m.revolute("J", m.ground, m.link("a", length=length, mass=1))
    return Scene(m, {"J": motion.polynomial(0, 1)})
"""
PLAIN = "def scene():\n    return arm(Size(length=0.75).length)\n"
HELPED = "import json, sizes\nassert json.dumps\ndef scene():\n    import more.late\n"
HELPED += "    return arm(sizes.LENGTH * more.late.FACTOR)\n"
OUTER = """
import sizes
def scene():
    other = load_case({inner!r}).scene.mechanism.links["a"].length
    import sizes as again
    assert again is sizes
    return arm(other * sizes.LENGTH)
"""


def write(path, text, length=None):
    """A case, with helpers beside it if a length is given, one of which has the name of another."""
    path.parent.mkdir(exist_ok=True, parents=True)
    path.write_text(HEAD + text)
    if length is not None:
        (path.parent / "more").mkdir(exist_ok=True)
        for name, of in (
            ("sizes", f"LENGTH = {length}\n"),
            ("json", "raise RuntimeError\n"),
            ("more/__init__", ""),
            ("more/late", "FACTOR = 2.0\n"),
        ):
            (path.parent / f"{name}.py").write_text(of)
    return path


def length_of(case):
    return load_case(case).scene.mechanism.links["a"].length


def test_each_case_has_its_own_helpers(tmp_path):
    """Of one name, also in threads, and where one loads another; anew where one was changed; and
    the path is as it was.
    """
    cases = [write(tmp_path / str(k) / "case.py", HELPED, k + 1.0) for k in range(4)]
    outer, before = (
        write(tmp_path / "o" / "case.py", OUTER.format(inner=str(cases[1])), 3.0),
        [*sys.path],
    )
    for _ in range(2):
        assert [length_of(path) for path in (*cases, outer)] == [2.0, 4.0, 6.0, 8.0, 12.0]
    with ThreadPoolExecutor(4) as pool:
        assert list(pool.map(length_of, 3 * cases)) == 3 * [2.0, 4.0, 6.0, 8.0]
    write(cases[0], HELPED, 10.25)
    assert length_of(cases[0]) == 20.5
    assert sys.path == before


def test_a_case_is_sent_to_another_process_and_loaded_anew_there(tmp_path):
    """Whatever its name is; a scene is not sent, and says so."""
    path = write(tmp_path / "a ü.b c" / "1 ü.x.py", PLAIN)
    case = load_case(path)
    sent = pickle.dumps(case)
    text = f"import pickle; print(pickle.loads({sent!r}).scene.mechanism.links['a'].length)"
    assert python(text) == "0.75\n"
    assert pickle.loads(sent).path == case.path
    with pytest.raises(PickleError, match=r"^a Scene cannot be pickled, .* send a Case from load_"):
        pickle.dumps([case.scene])
    assert copy.copy(case.scene) is copy.deepcopy({"scene": case.scene})["scene"] is case.scene


@pytest.mark.parametrize(
    "raised",
    ["BaseException('x')", "SystemExit('x')", "type('Odd', (BaseException,), {})('x')"],
)
@pytest.mark.parametrize("where", ["", "def scene():\n    "])
def test_whatever_a_case_raises_is_one_line(tmp_path, raised, where):
    """But an interrupt, which is one; and once it is mended the case is loaded."""
    path = tmp_path / "case.py"
    path.write_text(f"{where}raise {raised}\n")
    with pytest.raises(CaseError, match=r"^case .*, line [12]: \w+: x$"):
        load_case(path)
    path.write_text(f"{where}raise KeyboardInterrupt\n")
    with pytest.raises(KeyboardInterrupt):
        load_case(path)
    assert length_of(write(path, PLAIN)) == 0.75
