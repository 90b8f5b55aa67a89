"""Signals, real ones to real processes: one line and status 130 at any moment, and what is ignored
stays so.
"""

import errno
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
from internals import interrupts

from lagrange_casadi.cli import progress

CASE = Path(__file__).parents[2] / "cases" / "slider_crank"
LINE = "error: interrupted; no file was left incomplete\n"
RUN = ["run", str(CASE), "--t", "0:0.08:9", "--no-figures"]
SWEEP = ["sweep", str(CASE), "--t", "0:0.08:21", "--want", "effort", "--want", "section:rod"]
SHORT = ["--grid", "l=0.11:0.4:25", "--grid", "r=0.05:0.1:6"]
LONG = ["--grid", "l=0.11:0.4:4000", "--grid", "r=0.05:0.1:250"]
KEPT = (
    r"error: stopped; [\d ]+ of 1 000 000 designs are kept in x\.h5\.parts:"
    r" continue with --resume\n"
)


def program(*arguments, **keywords):
    return sweeps.process(sys.executable, "-m", "lagrange_casadi", *arguments, **keywords)


def caught(process, number):
    """Whether a process handles a signal by now; nothing of ours runs before it does."""
    try:
        status = Path(f"/proc/{process.pid}/status").read_text()
    except FileNotFoundError:
        pytest.skip("needs /proc")
    words = re.search(r"SigCgt:\s+([0-9a-f]+)", status)
    return words and int(words[1], 16) >> (number - 1) & 1


def ignoring(*numbers):
    """What makes a process start as ``nohup`` and shells start theirs."""
    return {"preexec_fn": lambda: [signal.signal(number, signal.SIG_IGN) for number in numbers]}


@pytest.mark.sampled(7)
@pytest.mark.parametrize(
    "number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP], ids=lambda number: number.name
)
@pytest.mark.parametrize(
    "arguments",
    [["--help"], RUN, [*SWEEP, *SHORT, "--force"]],
    ids=lambda arguments: arguments[0].strip("-"),
)
def test_an_interrupt_at_any_moment_is_one_line(here, arguments, number):
    for delay in (0.0, 0.03, 0.1, 0.2, 0.4):
        with program(*arguments) as stopped:
            sweeps.wait_for(lambda: stopped.poll() is not None or caught(stopped, signal.SIGTERM))
            time.sleep(delay)
            stopped.send_signal(number)
            out, err = stopped.communicate(timeout=60)
        # Python ends itself by SIGINT, which is 130 for shells too, if that came while a text was
        # executed, as dataclasses do.
        executed = stopped.returncode == -signal.SIGINT and err
        if stopped.returncode == 130 or executed:
            assert err == LINE or re.fullmatch(r"error: stopped; [^\n]*\n", err)
        else:  # it was done, or Python itself was about to end
            assert stopped.returncode in (0, -number)
            assert err == ""
            assert out


@pytest.mark.parametrize(
    "number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP], ids=lambda number: number.name
)
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
    "another-error": (
        f"def scene():\n    try:\n        {READY}\n    finally:\n        raise ValueError\n"
    ),
    "swallowed": f"try:\n    {READY}\nexcept BaseException:\n    time.sleep(60)\n",
    "pool": (
        "import multiprocessing\n"
        "def scene():\n"
        "    with multiprocessing.get_context('fork').Pool(2) as pool:\n"
        "        print('ready', flush=True)\n"
        "        pool.map(time.sleep, [60, 60, 60])\n"
    ),
}


@pytest.mark.sampled(11)
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM], ids=lambda number: number.name)
@pytest.mark.parametrize("text", WAITS.values(), ids=WAITS)
def test_an_interrupt_in_a_case_is_one_line(here, tmp_path_factory, text, number):
    """As a terminal sends it: to all processes that were started there."""
    case = tmp_path_factory.mktemp("waiting") / "case.py"
    case.write_text(f"import time\n{text}")
    with program("run", str(case), "--no-figures", start_new_session=True) as stopped:
        assert stopped.stdout.readline() == "ready\n"
        time.sleep(0.2)
        os.killpg(stopped.pid, number)
        try:
            said = stopped.communicate(timeout=5)
        except subprocess.TimeoutExpired:
            # Of a case with threads of its own, as a pool has, the system may give one the signal,
            # which wakes no other: once more.
            assert "Pool" in text
            os.killpg(stopped.pid, number)
            said = stopped.communicate(timeout=15)
        assert said == ("", LINE)
    assert stopped.returncode == 130
    assert not list(here.iterdir())


def test_other_programs_keep_their_signals():
    text = (
        "import signal, sys; sys.argv[0] = '-m'; before = [signal.getsignal(n) for n in (2, 15)];"
        " import lagrange_casadi; assert before == [signal.getsignal(n) for n in (2, 15)]"
    )
    subprocess.run([sys.executable, "-c", text], check=True)


def test_what_is_ignored_is_no_interrupt():
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        assert interrupts() == [signal.SIGINT, signal.SIGTERM]
    finally:
        signal.signal(signal.SIGHUP, before)
    assert interrupts() == [signal.SIGINT, signal.SIGTERM, signal.SIGHUP]


@pytest.mark.long
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP], ids=lambda number: number.name)
def test_a_sweep_keeps_its_blocks(here, number):
    with program(*SWEEP, *LONG, "--out", "x.h5") as stopped:
        sweeps.wait_for(lambda: list(here.glob("x.h5.parts/*.part")))
        stopped.send_signal(number)
        out, err = stopped.communicate(timeout=60)
    assert stopped.returncode == 130
    assert out == ""
    assert re.fullmatch(KEPT, err)


@pytest.mark.long
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM], ids=lambda number: number.name)
def test_an_interrupt_comes_through_while_a_long_axis_is_written(here, number):
    """It takes minutes; the blocks that were committed before stay."""
    with program(*SWEEP, "--grid", "l=0.11:0.4:200000000", "--out", "x.h5") as stopped:
        sweeps.wait_for(
            lambda: [
                path
                for path in here.glob("x.h5.parts/joined.h5")
                if path.stat().st_size > 1_000_000
            ]
        )
        stopped.send_signal(number)
        out, err = stopped.communicate(timeout=60)
    assert (stopped.returncode, out) == (130, "")
    note, error = err.splitlines(keepends=True)[-2:]
    assert re.fullmatch(
        r"note: 200 000 000 designs take about .* of a core and a file of up to \S+ GB\n", note
    )
    assert re.fullmatch(KEPT.replace("1 000 000", "200 000 000"), error)
    assert sorted(path.suffix for path in here.glob("x.h5.parts/*"))[-1] == ".part"
    assert not list(here.glob("x.h5.parts/joined.h5"))


ITERATED, NEWTON = str(CASE.parent / "beam_pump"), ["--newton", "1000", "--no-figures"]
STEPPING = {
    "compiled": ["run", ITERATED, *NEWTON, "--t", "0:6:10000001"],
    "interpreted": ["run", ITERATED, *NEWTON, "--t", "0:6:1000001", "--backend", "vm"],
    "swept": [
        "sweep",
        ITERATED,
        *words("--newton 1000 --want effort --t 0:6:2000001 --grid r=0.9:1:50"),
    ],
    "swept-interpreted": [
        "sweep",
        ITERATED,
        *words("--newton 1000 --t 0:6:20001 --grid r=0.9:1:50 --backend vm"),
    ],
}


@pytest.mark.long
@pytest.mark.parametrize(
    ("name", "number"), zip(STEPPING, [signal.SIGINT, signal.SIGTERM] * 2, strict=True)
)
def test_an_interrupt_does_not_wait_for_newtons_steps(here, name, number):
    """The whole takes minutes or hours."""
    with program(*STEPPING[name]) as stopped:
        sweeps.wait_for(lambda: caught(stopped, signal.SIGALRM))
        time.sleep(2.0)
        stopped.send_signal(number)
        out, err = stopped.communicate(timeout=20)
    assert (stopped.returncode, out) == (130, "")
    assert re.search(
        r"error: (interrupted; no file was left incomplete|stopped; nothing was done yet)\n$", err
    )
    assert not list(here.iterdir())


@pytest.mark.long
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGHUP], ids=lambda number: number.name)
def test_what_was_ignored_at_the_start_stays_ignored(here, number):
    """As by ``nohup``, and of a script's background jobs."""
    with program(*SWEEP, *LONG, "--out", "x.h5", **ignoring(number)) as started:
        sweeps.wait_for(lambda: list(here.glob("x.h5.parts/*.part")))
        for _ in range(3):
            started.send_signal(number)
            time.sleep(0.02)
        assert started.poll() is None
        started.send_signal(signal.SIGTERM)
        assert re.fullmatch(KEPT, started.communicate(timeout=60)[1])


@pytest.mark.long
def test_a_terminal_that_goes_stops_a_sweep_as_told(here):
    """The system sends the signal, and whatever is written to the terminal fails from then on."""
    terminal, side = os.openpty()
    command = [sys.executable, "-m", "lagrange_casadi", *SWEEP, *LONG, "--out", "x.h5"]
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


@pytest.mark.long
def test_a_sweep_that_was_held_goes_on(here):
    def parts():
        return len(list(here.glob("x.h5.parts/*.part")))

    with program(*SWEEP, *LONG, "--out", "x.h5") as held:
        sweeps.wait_for(parts)
        held.send_signal(signal.SIGSTOP)
        assert os.waitpid(held.pid, os.WUNTRACED)[1] == signal.SIGSTOP << 8 | 0x7F
        before = parts()
        held.send_signal(signal.SIGCONT)
        sweeps.wait_for(lambda: parts() > before)
        held.send_signal(signal.SIGTERM)
        assert re.fullmatch(KEPT, held.communicate(timeout=60)[1])


@pytest.mark.parametrize("shown", [progress.Lines, progress.Bar])
def test_progress_that_nobody_sees_stops_nothing(monkeypatch, shown):
    class Gone:
        def fail(self, *_text):
            raise OSError(errno.EIO, os.strerror(errno.EIO))

        write = flush = fail

    monkeypatch.setattr(sys, "stderr", Gone())
    told = shown()
    assert not told.begun
    for what, done, total in (("designs", 10, 100), ("designs", 100, 100), ("file", 1.0, 1.0)):
        told(what, done, total)
    told.close()
    assert told.begun


def test_output_that_cannot_be_written_is_one_line(here):
    command = [sys.executable, "-m", "lagrange_casadi", "info", str(CASE)]
    with open("/dev/full", "w") as full:
        done = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, check=False)
    assert done.returncode == 1
    assert done.stderr == "error: cannot write to standard output: No space left on device\n"


CALLED_LATE = """
import weakref

def late(_):
    raise KeyboardInterrupt

class One:
    pass

one = One()
seen = weakref.ref(one, late)
del one
"""


def test_what_python_ignores_of_an_interrupt_is_not_told(here):
    """A callback of a weak reference cannot raise; the interrupt is repeated until it arrives."""
    Path("case.py").write_text(CALLED_LATE)
    with program("info", "case.py") as asked:
        assert asked.communicate()[1] == "error: case case.py: has no function scene()\n"
