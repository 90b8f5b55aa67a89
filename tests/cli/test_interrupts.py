"""Signals, real ones to real processes: one line and status 130 at any moment, and what is ignored
stays so.
"""

import fcntl
import os
import re
import shutil
import signal
import subprocess
import sys
import termios
import time
from pathlib import Path

import pytest
import sweeps
from commands import words

LINE = "error: interrupted; no file was left incomplete\n"
RUN = words("run CASE --t 0:0.08:9 --no-figures")
SWEEP = words("sweep CASE --t 0:0.08:21 --want effort --want section:rod --out x.h5")
SHORT = words("--grid l=0.11:0.4:25 --grid r=0.05:0.1:6 --force")
LONG = words("--grid l=0.11:0.4:4000 --grid r=0.05:0.1:250")
KEPT = (
    r"error: stopped; [\d ]+ of 1 000 000 designs are kept in x\.h5\.parts:"
    r" continue with --resume\n"
)
INT, TERM, HUP = signal.SIGINT, signal.SIGTERM, signal.SIGHUP


def program(*arguments, **keywords):
    return sweeps.process(sys.executable, "-m", "lagrange_casadi", *arguments, **keywords)


def handles(process, number):
    """Whether a process handles a signal by now; nothing of ours runs before it does."""
    try:
        status = Path(f"/proc/{process.pid}/status").read_text()
    except FileNotFoundError:
        pytest.skip("needs /proc")
    found = re.search(r"SigCgt:\s+([0-9a-f]+)", status)
    return found and int(found[1], 16) >> (number - 1) & 1


@pytest.mark.sampled(7)
@pytest.mark.parametrize("number", [INT, TERM, HUP])
@pytest.mark.parametrize("arguments", [["--help"], RUN, [*SWEEP, *SHORT]])
def test_an_interrupt_at_any_moment_is_one_line(here, arguments, number):
    for delay in (0.0, 0.03, 0.1, 0.2, 0.4):
        with program(*arguments) as stopped:
            sweeps.wait_for(lambda: stopped.poll() is not None or handles(stopped, TERM))
            time.sleep(delay)
            stopped.send_signal(number)
            out, err = stopped.communicate(timeout=60)
        # Python ends itself by SIGINT, which is 130 for shells too, if that came while a text was
        # executed, as dataclasses do.
        if stopped.returncode == 130 or (stopped.returncode == -INT and err):
            assert err == LINE or re.fullmatch(r"error: stopped; [^\n]*\n", err)
        else:  # it was done, or Python itself was about to end
            assert stopped.returncode in (0, -number)
            assert err == ""
            assert out


@pytest.mark.parametrize("number", [INT, TERM, HUP])
@pytest.mark.parametrize(
    "command", [[shutil.which("lagrange-casadi")], [sys.executable, "-m", "lagrange_casadi"]]
)
def test_an_interrupt_while_modules_are_imported_is_one_line(here, command, number):
    """Here of one that takes its time, and would not let an exception through."""
    (here / "numpy.py").write_text(
        "import time\nprint('ready', flush=True)\ntry:\n    time.sleep(60)\nexcept BaseException:\n"
        "    raise ImportError('no')\n"
    )
    path = os.pathsep.join([str(here), *sys.path])
    with sweeps.process(*command, *RUN, env={**os.environ, "PYTHONPATH": path}) as stopped:
        assert stopped.stdout.readline() == "ready\n"
        stopped.send_signal(number)
        assert stopped.communicate(timeout=60) == ("", LINE)
    assert stopped.returncode == 130


READY = "print('ready', flush=True); time.sleep(60)"
WAITS = {
    "import": f"{READY}\n",
    "scene": f"def scene():\n    {READY}\n",
    "another-error": f"try:\n    {READY}\nfinally:\n    raise ValueError\n",
    "swallowed": f"try:\n    {READY}\nexcept BaseException:\n    time.sleep(60)\n",
    "text": f"def scene():\n    exec({READY!r})\n",
    "formulas": (
        "from lagrange_casadi import load_case\n"
        "def scene():\n"
        "    print('ready', flush=True)\n"
        "    return load_case('slider_crank').scene\n"
    ),
    "pool": (
        "import multiprocessing\n"
        "def scene():\n"
        "    with multiprocessing.get_context('fork').Pool(2) as pool:\n"
        "        print('ready', flush=True)\n"
        "        pool.map(time.sleep, [60, 60, 60])\n"
    ),
}


@pytest.mark.sampled(5)
@pytest.mark.parametrize("number", [INT, TERM])
@pytest.mark.parametrize("text", WAITS)
def test_an_interrupt_in_a_case_is_one_line(here, tmp_path_factory, text, number):
    """As a terminal sends it: to all processes that were started there."""
    case = tmp_path_factory.mktemp("waiting") / "case.py"
    case.write_text(f"import time\n{WAITS[text]}")
    asked = ["run", str(case), *words("--no-figures --t 0:0.08:10000000 --backend vm")]
    with program(*asked, start_new_session=True) as stopped:
        assert stopped.stdout.readline() == "ready\n"
        time.sleep(0.2)
        os.killpg(stopped.pid, number)
        try:
            out, err = stopped.communicate(timeout=10)
        except subprocess.TimeoutExpired:
            # Of a case with threads of its own, as a pool has, the system may give one the signal,
            # which wakes no other: once more.
            assert text in ("pool", "formulas")
            os.killpg(stopped.pid, number)
            out, err = stopped.communicate(timeout=15)
        assert (out, re.sub("note: 10 000 000 instants take about .*\n", "", err)) == ("", LINE)
    assert stopped.returncode == 130
    assert not list(here.iterdir())


def test_other_programs_keep_their_signals():
    text = (
        "import signal, sys; sys.argv[0] = '-m'; before = [signal.getsignal(n) for n in (2, 15)];"
        " import lagrange_casadi; assert before == [signal.getsignal(n) for n in (2, 15)]"
    )
    subprocess.run([sys.executable, "-c", text], check=True)


def test_what_python_ignores_of_an_interrupt_is_not_told(here):
    """A callback of a weak reference cannot raise; the interrupt is repeated until it arrives."""
    Path("case.py").write_text(
        "import weakref\n\ndef late(_):\n    raise KeyboardInterrupt\n\nclass One:\n    pass\n\n"
        "one = One()\nseen = weakref.ref(one, late)\ndel one\n"
    )
    with program("info", "case.py") as asked:
        assert asked.communicate()[1].startswith("error: case case.py: has no function scene();")


PUMP = words("beam_pump --newton 1000")
STEPPING = [
    ["run", *PUMP, *words("--no-figures --t 0:6:10000001")],
    ["run", *PUMP, *words("--no-figures --t 0:6:1000001 --backend vm")],
    ["sweep", *PUMP, *words("--want effort --t 0:6:2000001 --grid r=0.9:1:50")],
]


@pytest.mark.long
@pytest.mark.parametrize(("arguments", "number"), zip(STEPPING, [INT, TERM, INT], strict=True))
def test_an_interrupt_does_not_wait_for_newtons_steps(here, arguments, number):
    """The whole takes minutes or hours."""
    with program(*arguments) as stopped:
        sweeps.wait_for(lambda: handles(stopped, signal.SIGALRM))
        time.sleep(2.0)
        stopped.send_signal(number)
        out, err = stopped.communicate(timeout=20)
    assert (stopped.returncode, out) == (130, "")
    assert err.endswith(("; no file was left incomplete\n", "stopped; nothing was done yet\n"))
    assert not list(here.iterdir())


@pytest.mark.long
@pytest.mark.parametrize("number", [INT, TERM])
def test_an_interrupt_comes_through_while_a_long_axis_is_written(here, number):
    """It takes minutes; the blocks that were committed before stay."""
    joined = here / "x.h5.parts" / "joined.h5"
    with program(*SWEEP, "--grid", "l=0.11:0.4:200000000") as stopped:
        sweeps.wait_for(lambda: joined.exists() and joined.stat().st_size > 1_000_000)
        stopped.send_signal(number)
        out, err = stopped.communicate(timeout=60)
    assert (stopped.returncode, out) == (130, "")
    assert re.fullmatch(KEPT.replace("1 000 000", "200 000 000"), err.splitlines(keepends=True)[-1])
    assert list(here.glob("x.h5.parts/*.part"))
    assert not joined.exists()


@pytest.mark.long
@pytest.mark.parametrize("number", [INT, HUP])
def test_a_sweep_ends_by_what_it_heeds_and_keeps_its_blocks(here, number):
    """What was ignored at its start stays ignored, as by ``nohup`` and of a script's background
    jobs; and one that was held goes on.
    """

    def parts():
        return len(list(here.glob("x.h5.parts/*.part")))

    deaf = {"preexec_fn": lambda: signal.signal(number, signal.SIG_IGN)}
    with program(*SWEEP, *LONG, **deaf) as started:
        sweeps.wait_for(parts)
        started.send_signal(number)
        started.send_signal(signal.SIGSTOP)
        assert os.waitpid(started.pid, os.WUNTRACED)[1] == signal.SIGSTOP << 8 | 0x7F
        before = parts()
        started.send_signal(signal.SIGCONT)
        sweeps.wait_for(lambda: parts() > before)
        started.send_signal(TERM)
        out, err = started.communicate(timeout=60)
    assert (started.returncode, out) == (130, "")
    assert re.fullmatch(KEPT, err)


@pytest.mark.long
def test_a_terminal_that_goes_stops_a_sweep_as_told(here):
    """The system sends the signal, and whatever is written to the terminal, as progress is, fails
    from then on.
    """
    terminal, side = os.openpty()
    command = [sys.executable, "-m", "lagrange_casadi", *SWEEP, *LONG]
    own = {"start_new_session": True, "preexec_fn": lambda: fcntl.ioctl(0, termios.TIOCSCTTY, 0)}
    with subprocess.Popen(command, stdin=side, stdout=side, stderr=side, **own) as started:
        os.close(side)
        try:
            sweeps.wait_for(lambda: list(here.glob("x.h5.parts/*.part")))
            os.close(terminal)
            assert started.wait(timeout=60) == 130
        finally:
            started.kill()
    assert list(here.glob("x.h5.parts/*.part"))
