"""Compilers that fail, hang, cannot be started or say what is no text; and what is built again."""

import hashlib
import os
import shutil
from pathlib import Path

import pytest
import sweeps
from compiled import fake_compiler
from internals import compiler
from mechanisms import slider_crank

from lagrange_casadi import evaluate, optimise, prepare, refine, sweep, tolerances
from lagrange_casadi.cli import main
from lagrange_casadi.errors import CompilerError

CASE = Path(__file__).parents[2] / "cases" / "slider_crank"
TELLS = 'test "$1" = --version && exit 0;'
HANGS = "sleep 1000 & echo $! >> {pid}; wait"
"""As a driver does that has others compile: it waits for one that holds its pipes open."""

FAILS = {
    "hangs": (
        f"{TELLS} {HANGS}",
        r"fake-cc did not end within 0\.5 s and was stopped; \$LAGRANGE_CASADI_COMPILER_TIMEOUT",
    ),
    "does not listen": (
        f"{TELLS} trap '' TERM INT HUP; {HANGS}; sleep 1000",
        r"did not end within 0\.5 s",
    ),
    "has written half": (
        f'{TELLS} for last; do :; done; {{real}} "$@"; sleep 1000',
        r"did not end within 0\.5 s",
    ),
    "hangs at its version": (
        HANGS,
        r"^\$CC = '.*fake-cc' did not report its version within 0\.\d+ s; \$LAGRANGE_CASADI_CO",
    ),
    "refuses": (
        f'{TELLS} echo "x.c:1: error: no" >&2; exit 3',
        r"fake-cc failed with status 3: x\.c:1: error: no \(whole message in .*\.log\)",
    ),
    # As one that speaks Latin-1: \351 is its e with an accent.
    "says no text": (
        r"""printf 'version \351\n'; printf 'x.c:1: error: d\351fini \377\n' >&2; test "$1" = --version""",  # noqa: E501
        "fake-cc failed with status 1: x\\.c:1: error: d\ufffdfini \ufffd ",
    ),
    "does not run": (
        "exit 3",
        r"^\$CC = '.*fake-cc' does not run; unset it, or name a compiler such",
    ),
    "builds no library": (
        f'{TELLS} while test "$1" != -o; do shift; done; echo no > "$2"',
        "the library built by .*fake-cc does not load",
    ),
    "builds an empty library": (
        f'{TELLS} while test "$1" != -o; do shift; done; {{real}} -shared -x c /dev/null -o "$2"',
        "the library built by .*fake-cc does not load",
    ),
    "says much": (f"{TELLS} printf 'error: %05000d' 0 >&2; exit 1", r"error: 0{100,900}[^0]"),
}


def gone(path):
    """Whether no process whose number a file has runs still."""

    def runs(number):
        try:
            return "\nState:\tZ" not in Path(f"/proc/{number}/status").read_text()
        except OSError:
            return False

    return not any(runs(int(word)) for word in path.read_text().split())


@pytest.mark.parametrize("name", FAILS)
def test_a_compiler_that_fails_is_quoted_and_leaves_nothing(
    tmp_path, fresh_cache, monkeypatch, name
):
    """No process, and no library that is believed; its whole message is kept."""
    script, says = FAILS[name]
    pid = tmp_path / "pid"
    monkeypatch.setenv(compiler.VARIABLE, "0.5")
    fake_compiler(tmp_path, monkeypatch, script.format(pid=pid, real=shutil.which("cc")))
    with pytest.raises(CompilerError, match=says):
        evaluate(slider_crank(["effort"]), backend="c")
    if pid.exists():
        sweeps.wait_for(lambda: gone(pid))
    assert name.endswith("library") or not list(fresh_cache.glob("*.so"))
    if name == "refuses":
        assert [path.read_text() for path in fresh_cache.glob("*.log")] == ["x.c:1: error: no\n"]


def test_another_that_hangs_at_its_version_is_passed_over(tmp_path, monkeypatch):
    pid = tmp_path / "pid"
    fake_compiler(tmp_path, monkeypatch, HANGS.format(pid=pid)).rename(tmp_path / "cc")
    monkeypatch.delenv("CC")
    monkeypatch.setenv("PATH", f"{tmp_path}{os.pathsep}{os.environ['PATH']}")
    monkeypatch.setenv(compiler.VARIABLE, "4")
    says = r"the compiler cc is passed over: it did not report its version within 0\.2 s"
    with pytest.warns(UserWarning, match=says):
        found = compiler.find_compiler()
    assert found is None or found.command != ("cc",)
    sweeps.wait_for(lambda: gone(pid))


@pytest.mark.parametrize("text", ["soon", "0", "-1", "nan", "1_0"])
def test_a_time_limit_that_is_none_is_one_line(here, fresh_cache, monkeypatch, capsys, text):
    monkeypatch.setenv(compiler.VARIABLE, text)
    monkeypatch.setenv("CC", f"{shutil.which('cc')} -pipe")  # one that was not looked at before
    assert main(["run", str(CASE), "--no-figures", "--t", "0:0.08:9", "--backend", "c"]) == 1
    says = f"error: $LAGRANGE_CASADI_COMPILER_TIMEOUT = '{text}': expected a number of seconds"
    assert capsys.readouterr().err == f"{says} above 0; without it they are 600\n"


def sealed(library, content):
    """Give a library that is mapped into this process another content, and its digest."""
    library.unlink()
    library.write_bytes(content)
    library.with_suffix(".sha256").write_text(hashlib.sha256(content).hexdigest())


DAMAGES = {
    "half": (lambda library, whole: library.with_suffix(".sha256").write_bytes(b""), "was damaged"),
    "cut": (
        lambda library, whole: (library.unlink(), library.write_bytes(whole[: len(whole) // 2])),
        "was damaged",
    ),
    "of another machine": (
        lambda library, whole: sealed(library, b"\x7fELF of another kind"),
        r"does not load \(.*\)",
    ),
    "open to others": (
        lambda library, whole: library.chmod(0o666),
        r"is not trusted \(others may write into .*\.so\)",
    ),
}


@pytest.mark.parametrize("name", DAMAGES)
def test_a_library_that_cannot_be_trusted_is_built_again(fresh_cache, name):
    """A planted one would run, for its digest fits."""
    damage, says = DAMAGES[name]
    first = evaluate(slider_crank(["effort"]), backend="c")
    (library,) = fresh_cache.glob("*.so")
    whole = library.read_bytes()
    damage(library, whole)
    with pytest.warns(UserWarning, match=rf"the cached library .*\.so {says} and is built again"):
        again = evaluate(slider_crank(["effort"]), backend="c")
    assert library.read_bytes() == whole
    assert library.stat().st_mode & 0o22 == 0
    assert (again.effort("O") == first.effort("O")).all()


def test_a_changed_parameter_derives_and_compiles_nothing(fresh_cache):
    scene = slider_crank()
    evaluate(scene, backend="c")
    before = sorted(fresh_cache.iterdir())
    evaluate(scene, backend="c", parameters={"l": 0.3, "m2": 1.0}, t=(0, 1, 7))
    assert sorted(fresh_cache.iterdir()) == before
    assert sorted(path.suffix for path in before) == [".c", ".graph", ".sha256", ".so"]


INSTALL = r".* or the package ziglang was found; pip install 'lagrange_casadi\[compiler\]'"


@pytest.fixture
def no_compiler(monkeypatch):
    for variable in ("CC", "CXX"):
        monkeypatch.delenv(variable, raising=False)
    monkeypatch.setenv("PATH", "")
    monkeypatch.setattr(compiler.importlib.util, "find_spec", lambda _: None)


def test_without_a_compiler_the_virtual_machine_serves_and_says_so(no_compiler, tmp_path):
    scene, designs = slider_crank(["effort"]), "designs need a compiler: none of "
    with pytest.warns(UserWarning, match=r"no C or C\+\+ compiler found"):
        solution = evaluate(scene)
    assert solution.provenance.backend == "vm"
    searched = {"minimise": "peak:effort:O", "over": {"l": (0.2, 0.3)}}
    for ask, needs in (
        (lambda: evaluate(scene, backend="c"), r"backend 'c' needs a C compiler: none of \$CC, "),
        (
            lambda: evaluate(scene, backend="lanes"),
            r"backend 'lanes' needs a C\+\+ compiler: none of \$CXX, ",
        ),
        (
            lambda: evaluate(scene, precision="single"),
            r"precision 'single' needs a compiler: none of \$CXX, ",
        ),
        (lambda: refine(scene, solution), "peaks between instants need a compiler: none of "),
        (lambda: prepare(scene), designs),
        (lambda: sweep(scene, {"l": [0.2, 0.3]}, out=tmp_path / "x.h5"), designs),
        (lambda: optimise(scene, **searched), designs),
        (lambda: tolerances(scene, {"l": 0.001}), designs),
    ):
        with pytest.raises(CompilerError, match=needs + INSTALL):
            ask()
    assert not list(tmp_path.iterdir())


def test_a_failing_cxx_compiler_is_said_and_c_serves(tmp_path, fresh_cache, monkeypatch):
    script = f'{TELLS} echo "x.cpp:1: error: no" >&2; exit 3'
    fake_compiler(tmp_path, monkeypatch, script, "CXX")
    says = r"fake-cc failed with status 3: x\.cpp:1: error: no .*; using scalar C"
    with pytest.warns(UserWarning, match=says):
        assert evaluate(slider_crank(["effort"])).provenance.backend == "c"
    with pytest.raises(CompilerError, match="fake-cc failed with status 3"):
        evaluate(slider_crank(["effort"]), backend="lanes")
