"""Compilers that hang, cannot be started, or say what is no text; and what of the cache does not
load.
"""

import os
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
import sweeps
from commands import words
from compiled import fake_compiler
from internals import cache, compiler
from mechanisms import slider_crank

from lagrange_casadi import codegen, evaluate
from lagrange_casadi.cli import main
from lagrange_casadi.errors import CompilerError

CASE = Path(__file__).parents[2] / "cases" / "slider_crank"
TELLS = 'test "$1" = --version && exit 0;'
HANGS = "sleep 1000 & echo $! >> {pid}; wait"
"""As a driver does that has others compile: it waits for one that holds its pipes open."""


def is_there(number):
    """Whether a process runs still; one that ended and that nobody has asked about does not."""
    try:
        return "\nState:\tZ" not in Path(f"/proc/{number}/status").read_text()
    except OSError:
        return False


def pids(path):
    return [int(word) for word in path.read_text().split()]


def all_gone(path):
    sweeps.wait_for(lambda: not any(map(is_there, pids(path))))


@pytest.fixture
def pid(tmp_path):
    """Where what hangs leaves its number."""
    path = tmp_path / "pid"
    yield path
    for number in pids(path) if path.exists() else ():
        assert not is_there(number)


def test_a_compiler_that_hangs_is_stopped_with_all_it_started(
    tmp_path, fresh_cache, monkeypatch, pid
):
    fake_compiler(tmp_path, monkeypatch, f"{TELLS} {HANGS.format(pid=pid)}")
    monkeypatch.setenv(compiler.VARIABLE, "0.5")
    with pytest.raises(
        CompilerError,
        match=(
            r"fake-cc did not end within 0\.5 s and was stopped; \$LAGRANGE_CASADI_COMPILER_TIMEOUT"
            r" sets"
        ),
    ):
        evaluate(slider_crank(), backend="c")
    all_gone(pid)


def test_a_chosen_compiler_that_hangs_at_its_version_is_an_error(tmp_path, monkeypatch, pid):
    fake_compiler(tmp_path, monkeypatch, HANGS.format(pid=pid))
    monkeypatch.setenv(compiler.VARIABLE, "4")
    with pytest.raises(
        CompilerError,
        match=r"^\$CC = '.*fake-cc' did not report its version within 0\.2 s; \$LAGRANGE_CASADI_CO",
    ):
        codegen.find_compiler()
    all_gone(pid)


def test_another_that_hangs_at_its_version_is_passed_over(tmp_path, monkeypatch, pid):
    fake_compiler(tmp_path, monkeypatch, HANGS.format(pid=pid)).rename(tmp_path / "cc")
    monkeypatch.delenv("CC")
    monkeypatch.setenv("PATH", f"{tmp_path}{os.pathsep}{os.environ['PATH']}")
    monkeypatch.setenv(compiler.VARIABLE, "4")
    with pytest.warns(
        UserWarning,
        match=r"the compiler cc is passed over: it did not report its version within 0\.2 s",
    ):
        found = codegen.find_compiler()
    assert found is None or found.command != ("cc",)
    all_gone(pid)


@pytest.mark.parametrize("text", ["soon", "0", "-1", "nan", "1_0"])
def test_a_time_limit_that_is_none_is_one_line(here, fresh_cache, monkeypatch, capsys, text):
    monkeypatch.setenv(compiler.VARIABLE, text)
    compiler._find_compiler.cache_clear()
    assert main(["run", str(CASE), "--no-figures", "--t", "0:0.08:9", "--backend", "c"]) == 1
    assert (
        capsys.readouterr().err
        == f"error: $LAGRANGE_CASADI_COMPILER_TIMEOUT = '{text}': expected a number of seconds"
        " above 0; without it they are 600\n"
    )


@pytest.mark.long
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM], ids=lambda number: number.name)
@pytest.mark.parametrize("script", ["{hangs}", "{tells} {hangs}"], ids=["version", "compiling"])
def test_an_interrupt_stops_the_compiler(here, tmp_path_factory, monkeypatch, number, script):
    folder = tmp_path_factory.mktemp("fake")
    fake_compiler(
        folder, monkeypatch, script.format(tells=TELLS, hangs=HANGS.format(pid=folder / "pid"))
    )
    monkeypatch.setenv("XDG_CACHE_HOME", str(folder))
    command = [sys.executable, *words("-m lagrange_casadi run CASE --backend c --no-figures")]
    with sweeps.process(*command) as stopped:
        sweeps.wait_for((folder / "pid").exists)
        began = time.monotonic()
        stopped.send_signal(number)
        assert stopped.communicate(timeout=60) == (
            "",
            "error: interrupted; no file was left incomplete\n",
        )
    assert stopped.returncode == 130
    assert time.monotonic() - began < 10.0
    all_gone(folder / "pid")
    assert os.listdir(here) == []


def test_what_is_no_text_is_quoted_all_the_same(tmp_path, here, fresh_cache, monkeypatch, capsys):
    r"""As of a compiler that speaks Latin-1: \351 is its e with an accent."""
    fake_compiler(
        tmp_path,
        monkeypatch,
        r"""printf 'version \351\n'; printf 'x.c:1: error: d\351fini \377\n' >&2; test "$1" = --version""",  # noqa: E501
    )
    assert main(["run", str(CASE), "--backend", "c", "--no-figures"]) == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert re.fullmatch(
        r"error: .*fake-cc failed with status 1: x\.c:1: error: d\ufffdfini \ufffd \(whole message"
        r" in .*\.log\)",
        line,
    )


CROWDED = """
import os, sys
from lagrange_casadi.cli import main
import resource
resource.setrlimit(resource.RLIMIT_NOFILE, (64, 64))
held = []
try:
    while True:
        held.append(os.open(os.devnull, os.O_RDONLY))
except OSError:
    for _ in range({free}):
        os.close(held.pop())
from lagrange_casadi import codegen
from lagrange_casadi.errors import CompilerError
for language in ("c", "c++"):
    try:
        codegen.find_compiler(language)
        sys.exit("found")
    except CompilerError as error:
        print(error)
for number in held:
    os.close(number)
assert codegen.find_compiler() is not None
"""


@pytest.mark.sampled(2)
@pytest.mark.parametrize("free", [0, 3])
def test_too_few_descriptors_are_not_no_compiler(free):
    done = subprocess.run(
        [sys.executable, "-c", CROWDED.format(free=free)],
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert re.fullmatch(r"(cannot start \S+: Too many open files\n){2}", done.stdout)


def test_a_library_that_does_not_load_is_built_again(fresh_cache):
    """Whole as it is: of another machine, say, that shares the folder."""
    evaluate(slider_crank(), backend="c")
    (library,) = fresh_cache.glob("*.so")
    whole = library.read_bytes()
    library.unlink()
    library.write_bytes(b"\x7fELF of another kind")
    library.with_suffix(".sha256").write_text(cache.digest(library.read_bytes()))
    with pytest.warns(
        UserWarning, match=r"the cached library .*\.so does not load \(.*\) and is built again"
    ):
        evaluate(slider_crank(), backend="c")
    assert library.read_bytes() == whole


def test_what_a_killed_compiler_left_is_not_believed(tmp_path, fresh_cache, monkeypatch):
    """It wrote half of its output, and was stopped."""
    monkeypatch.setenv(compiler.VARIABLE, "0.5")
    real = shutil.which("cc")
    fake_compiler(tmp_path, monkeypatch, f'{TELLS} for last; do :; done; {real} "$@"; sleep 1000')
    with pytest.raises(CompilerError, match="did not end"):
        evaluate(slider_crank(), backend="c")
    assert not list(fresh_cache.glob("*.so"))
