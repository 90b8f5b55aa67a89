"""Cases are modules: dataclasses, helpers beside the file, other processes; and one case does not
see another's helpers.
"""

import copy
import pickle
import subprocess
import sys
import textwrap
from concurrent.futures import ThreadPoolExecutor

import pytest
from commands import words

from lagrange_casadi import case_modules, load_case
from lagrange_casadi.errors import CaseError, PickleError

ARM = """
def arm(length):
    m = Mechanism("arm")
    m.revolute("J", m.ground, m.link("a", length=length, mass=1))
    return Scene(m, {"J": motion.polynomial(0, 1)})
"""
HEAD = (
    "from __future__ import annotations\n\nfrom lagrange_casadi import Mechanism, Scene, motion\n"
)


def write(path, *texts):
    path.parent.mkdir(exist_ok=True)
    path.write_text("\n".join(textwrap.dedent(text) for text in texts))
    return path


def length_of(case):
    return case.scene.mechanism.links["a"].length


def test_dataclasses_with_postponed_annotations(tmp_path):
    path = write(
        tmp_path / "case.py",
        HEAD,
        ARM,
        """
        from dataclasses import KW_ONLY, dataclass
        from typing import ClassVar

        @dataclass(frozen=True)
        class Size:
            unit: ClassVar[str] = "m"
            _: KW_ONLY
            length: float = 0.5

        def scene():
            return arm(Size(length=0.75).length)
        """,
    )
    assert length_of(load_case(path)) == 0.75


def test_a_case_has_helpers_beside_it(tmp_path):
    """Found while it is loaded, and while its functions are called; packages too; and the path is
    as it was.
    """
    write(
        tmp_path / "case.py",
        HEAD,
        ARM,
        "import sizes\ndef scene():\n    import more.here\n    return arm(sizes.LENGTH *"
        " more.here.TWICE)\n",
    )
    write(tmp_path / "sizes.py", "LENGTH = 0.25\n")
    write(tmp_path / "more" / "__init__.py", "")
    write(tmp_path / "more" / "here.py", "TWICE = 2\n")
    before = list(sys.path)
    assert length_of(load_case(tmp_path)) == 0.5
    assert sys.path == before


def test_each_case_has_its_own_helpers(tmp_path):
    """Of one name, also in threads; and anew where one was changed."""
    for k in range(4):
        write(
            tmp_path / str(k) / "case.py",
            HEAD,
            ARM,
            "import sizes\ndef scene():\n    import late\n    return arm(sizes.LENGTH *"
            " late.FACTOR)\n",
        )
        write(tmp_path / str(k) / "sizes.py", f"LENGTH = {k + 1}.0\n")
        write(tmp_path / str(k) / "late.py", "FACTOR = 2.0\n")
    for _ in range(2):
        assert [length_of(load_case(tmp_path / str(k))) for k in range(4)] == [2.0, 4.0, 6.0, 8.0]
    with ThreadPoolExecutor(4) as pool:
        found = list(pool.map(lambda k: length_of(load_case(tmp_path / str(k % 4))), range(12)))
    assert found == 3 * [2.0, 4.0, 6.0, 8.0]
    write(tmp_path / "0" / "sizes.py", "LENGTH = 10.25\n")
    assert length_of(load_case(tmp_path / "0")) == 20.5


def test_a_case_may_load_another_one(tmp_path):
    """Each goes on with its own helpers."""
    inner = write(
        tmp_path / "inner" / "case.py",
        HEAD,
        ARM,
        "import sizes\ndef scene():\n    return arm(sizes.LENGTH)\n",
    )
    write(tmp_path / "inner" / "sizes.py", "LENGTH = 2.0\n")
    outer = f"""
    import sizes
    from lagrange_casadi import load_case

    def scene():
        other = load_case({str(inner)!r}).scene.mechanism.links["a"].length
        import sizes as again
        assert again is sizes
        return arm(other * sizes.LENGTH)
    """
    write(tmp_path / "case.py", HEAD, ARM, outer)
    write(tmp_path / "sizes.py", "LENGTH = 3.0\n")
    assert [length_of(load_case(path)) for path in (tmp_path, inner, tmp_path)] == [6.0, 2.0, 6.0]


def test_a_helper_does_not_hide_what_is_there_already(tmp_path):
    write(
        tmp_path / "case.py",
        HEAD,
        ARM,
        "import json\nassert json.dumps\ndef scene():\n    return arm(1.0)\n",
    )
    write(tmp_path / "json.py", "raise RuntimeError\n")
    assert length_of(load_case(tmp_path)) == 1.0
    import json

    assert json.dumps


POOLED = """
import multiprocessing
import sizes

class Half:
    def __init__(self, number):
        self.number = number

def half(number):
    return Half(number / 2)

def scene():
    with multiprocessing.get_context({method!r}).Pool(2) as pool:
        return arm(sum(found.number for found in pool.map(half, sizes.TWO)))
"""


@pytest.mark.long
@pytest.mark.parametrize("method", ["fork", "spawn", "forkserver"])
@pytest.mark.parametrize(
    "command",
    [
        ["-m", "lagrange_casadi"],
        ["-c", "import sys; from lagrange_casadi.cli import main; sys.exit(main())"],
    ],
)
def test_a_case_may_have_processes_work_for_it(here, tmp_path_factory, method, command):
    folder = tmp_path_factory.mktemp("pooled")
    write(folder / "case.py", HEAD, ARM, POOLED.format(method=method))
    write(folder / "sizes.py", "TWO = [1.0, 2.0]\n")
    asked = [
        sys.executable,
        *command,
        "run",
        str(folder),
        *words("--no-figures --t 0:1:5 --out x.h5"),
    ]
    done = subprocess.run(asked, capture_output=True, text=True, timeout=120, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert "wrote x.h5" in done.stdout


def test_what_a_case_defines_can_be_sent_to_another_process(tmp_path):
    path = write(
        tmp_path / "press.py",
        HEAD,
        ARM,
        "class Size:\n    length = 0.5\ndef scene():\n    return arm(Size.length)\n",
    )
    load_case(path)
    (module,) = (
        module
        for name, module in sys.modules.items()
        if name == case_modules._FILE + bytes(path).hex()
    )
    sent = pickle.dumps((module.Size, module.scene))
    program = (
        f"import pickle; size, scene = pickle.loads({sent!r}); print(size.length,"
        " scene().mechanism.name)"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert done.stdout == "0.5 arm\n"


def test_a_case_that_fails_is_no_module(tmp_path):
    """What was there of an earlier attempt stays."""
    path = write(tmp_path / "case.py", HEAD, ARM, "def scene():\n    return arm(1.0)\n")
    load_case(path)
    name = case_modules._FILE + bytes(path).hex()
    first = sys.modules[name]
    path.write_text("x = 1 / 0  # now\n")
    with pytest.raises(CaseError, match="line 1: ZeroDivisionError"):
        load_case(path)
    assert sys.modules[name] is first
    with pytest.raises(CaseError):
        load_case(write(tmp_path / "other.py", "1 / 0\n"))
    assert case_modules._FILE + bytes(tmp_path / "other.py").hex() not in sys.modules


def test_a_case_with_any_name(tmp_path):
    path = write(
        tmp_path / "a ü.b c" / "1 ü.x.py",
        HEAD,
        ARM,
        "import dataclasses\n@dataclasses.dataclass\nclass A:\n    x: int = 1\ndef scene():\n   "
        " return arm(1.0)\n",
    )
    assert length_of(load_case(path)) == 1.0


@pytest.mark.parametrize(
    "raised",
    [
        "BaseException('gone')",
        "GeneratorExit('gone')",
        "SystemExit('gone')",
        "type('Odd', (BaseException,), {})('gone')",
    ],
)
@pytest.mark.parametrize("where", ["", "def scene():\n    "])
def test_whatever_a_case_raises_is_one_line(tmp_path, raised, where):
    path = write(tmp_path / "case.py", f"{where}raise {raised}\n")
    with pytest.raises(CaseError, match=r"^case .*, line [12]: \w+: gone$"):
        load_case(path)


def test_ctrl_c_in_a_case_is_ctrl_c(tmp_path):
    with pytest.raises(KeyboardInterrupt):
        load_case(write(tmp_path / "case.py", "raise KeyboardInterrupt\n"))


def test_a_case_that_is_sent_is_loaded_anew(tmp_path):
    path = write(tmp_path / "press.py", HEAD, ARM, "def scene():\n    return arm(0.75)\n")
    case = load_case(path)
    sent = pickle.dumps(case)
    program = f"import pickle; print(pickle.loads({sent!r}).scene.mechanism.links['a'].length)"
    assert (
        subprocess.run(
            [sys.executable, "-c", program], capture_output=True, text=True, check=True
        ).stdout
        == "0.75\n"
    )
    again = pickle.loads(sent)
    assert again is not case
    assert again.path == case.path


def test_a_scene_says_why_it_is_not_sent(slider_crank):
    with pytest.raises(
        PickleError, match=r"^a Scene cannot be pickled, .* send a Case from load_case"
    ) as raised:
        pickle.dumps([slider_crank.scene])
    assert isinstance(raised.value, pickle.PicklingError)
    assert copy.copy(slider_crank.scene) is slider_crank.scene
    assert copy.deepcopy({"scene": slider_crank.scene})["scene"] is slider_crank.scene
