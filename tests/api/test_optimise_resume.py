"""Searches that are stopped or killed: what they leave, and how they go on. Real processes."""

import importlib
import json
import signal
import sys
import zlib

import h5py
import pytest
import sweeps
from commands import words
from internals import Search, journal_of, kept, verify

from lagrange_casadi import load_case, optimise
from lagrange_casadi.cli import main
from lagrange_casadi.errors import BusyError, PathError, StoreError

commands = importlib.import_module("lagrange_casadi.cli.optimise")

CASE = """
import casadi as ca
from lagrange_casadi import Mechanism, Scene
from lagrange_casadi.motion import expression
def scene():
    m = Mechanism("turning")
    duration, less = m.parameter("T", 1.0, "s", low=0.01), m.parameter("c", 0.0, "rad", low=0.0)
    m.revolute("O", m.ground, m.link("rod", length=0.3, mass=1.0))
    law = expression(lambda t: (ca.pi - less) * (3 * (t / duration) ** 2 - 2 * (t / duration) ** 3))
    return Scene(m, {"O": law}, t=(0, duration, 41), wanted=["effort"])
"""
ASKED = words(
    "optimise turning.py --minimise peak:effort:O --minimise T --over T=0.5:2 --over c=0:1"
)
ASKED += words("--subject-to c<=0.5 --points 8 --starts 2 --screen 8 --backend vm --figure x.svg")


def undrawn(_scene, _front, file, _ending):
    """A picture takes longer than these searches; the process that is stopped draws one."""
    file.write(b"x")


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(commands, "draw_front", undrawn)
    (tmp_path / "turning.py").write_text(CASE)
    return tmp_path


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The bytes of a search that nobody stops."""
    folder = tmp_path_factory.mktemp("whole")
    (folder / "turning.py").write_text(CASE)
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        patch.setattr(commands, "draw_front", undrawn)
        assert main([*ASKED, "--out", "x.h5"]) == 0
    return (folder / "x.h5").read_bytes()


def lines(path):
    return path.read_bytes().count(b"\n") if path.exists() else 0


@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    "number", [signal.SIGINT, pytest.param(signal.SIGKILL, marks=pytest.mark.long)]
)
def test_a_search_that_is_stopped_goes_on(number, here, whole, capfd):
    target = here / "x.h5"
    journal = journal_of(target)
    command = (sys.executable, "-m", "lagrange_casadi", *ASKED, "--out", "x.h5")
    with sweeps.process(*command, cwd=here) as running:
        sweeps.wait_for(lambda: lines(journal) > 8)
        running.send_signal(number)
        status = running.wait(60)
    kept = lines(journal)
    assert kept > 8
    if number == signal.SIGINT:
        assert status == 1
        verify("x.h5")
        assert main(["check", "x.h5"]) == 1
        assert "x.h5: the search was stopped before its end" in capfd.readouterr().err
        with h5py.File("x.h5") as file:
            assert file.attrs["stopped"]
            assert 2 <= len(file["front/objectives"]) < 8
        assert (here / "x.svg").read_text().lstrip().startswith("<?xml")
    else:
        assert not target.exists()
        journal.write_bytes(journal.read_bytes() + b'0123abcd {"of": "cut sho')
    capfd.readouterr()
    assert main([*ASKED, "--out", "x.h5"]) == 2
    assert (
        "is of an unfinished search: continue with --resume, or start anew with --force"
        in capfd.readouterr().err
    )
    assert (
        main(
            [*ASKED[:-2], "--figure", "y.svg", "--out", "x.h5", "--resume", "--transmission", "0.1"]
        )
        == 1
    )
    assert "is of another search: transmission was 0.05 and is 0.1" in capfd.readouterr().err
    assert lines(journal) >= kept
    assert main([*ASKED, "--out", "x.h5", "--resume"]) == 0
    out = capfd.readouterr().out
    assert out.startswith(
        "turning: 8 designs, none of which is better in all of peak:effort:O, T\n"
    )
    assert ", c = 0.5\n" in out
    assert not journal.exists()
    assert target.read_bytes() == whole


def asked(**words):
    scene = {
        "minimise": "peak:effort:O",
        "over": {"T": (0.5, 2.0), "c": (0.0, 1.0)},
        "backend": "vm",
        "starts": 3,
        "screen": 8,
    }
    return optimise(load_case("turning.py"), **scene | words)


def test_what_was_done_is_not_done_again(here):
    def stop(start, _objective, _excess, seen=[]):  # noqa: B006
        seen.append(start)
        if start == 2:
            raise KeyboardInterrupt

    assert asked(out="x.h5", progress=stop).stopped
    seen = []
    found = asked(out="x.h5", resume=True, progress=lambda *told: seen.append(told[0]))
    assert set(seen) == {2}
    assert len(found.starts) == 3
    assert found.evaluations == asked().evaluations


@pytest.mark.parametrize("objectives", ["peak:effort:O", ["peak:effort:O", "T"]])
def test_an_interrupt_between_ways_loses_nothing(here, objectives, monkeypatch):
    """It comes where a result is put together: that one is whole, and what would follow is not
    begun.
    """
    calls = iter(range(100))

    def evaluate(self, p, own=Search.evaluate):
        if next(calls) == 0:
            signal.raise_signal(signal.SIGINT)
        return own(self, p)

    monkeypatch.setattr(Search, "evaluate", evaluate)
    found = asked(minimise=objectives, out="x.h5", subject_to=["c <= 0.5"])
    assert found.converged
    verify("x.h5")
    assert found.stopped == (here / "x.h5.journal").exists() == isinstance(objectives, list)


def test_damaged_lines_are_done_again(here):
    def stop(start, _objective, _excess):
        if start == 2:
            raise KeyboardInterrupt

    assert asked(out="x.h5", progress=stop).stopped
    journal = here / "x.h5.journal"
    content = journal.read_bytes().splitlines(keepends=True)
    journal.write_bytes(content[0] + content[1].replace(b"1", b"7", 1) + content[2])
    seen = []
    whole = asked(out="x.h5", resume=True, progress=lambda *told: seen.append(told[0]))
    assert set(seen) == {0, 2}
    assert whole.objective == asked().objective
    journal.write_bytes(content[0] * 2)
    assert asked(out="x.h5", resume=True).objective == whole.objective
    journal.write_bytes(b"nothing of ours\n")
    with pytest.raises(StoreError, match="is not the file of a search"):
        asked(out="x.h5", resume=True)
    assert asked(out="x.h5", force=True).converged


def test_a_journal_whose_first_line_was_cut_holds_nothing(here):
    """At every byte of it: the same command begins once more.

    What no search wrote is left alone.
    """
    journal = here / "x.h5.journal"

    def stop_later(start, _objective, _excess):
        if start == 1:
            raise KeyboardInterrupt

    assert asked(out="x.h5", progress=stop_later).stopped
    first = journal.read_bytes().splitlines(keepends=True)[0]
    identity = json.loads(first[9:])["identity"]
    for resume in (False, True):
        for size in range(len(first)):
            journal.write_bytes(first[:size])
            with kept(here / "x.h5", identity, resume=resume, force=False) as begun:
                assert not begun.known
                assert journal.read_bytes().rstrip() == first.rstrip()
            assert not journal.exists()
    journal.write_bytes(first[:100])
    assert asked(out="x.h5").objective == asked().objective
    for other in (b"notes", b"x", first[:20] + b"\n", b"0123456z", b'01234567 {"of"', first[1:]):
        journal.write_bytes(other)
        with pytest.raises(PathError, match="is of an unfinished search"):
            asked(out="x.h5")
        with pytest.raises(StoreError, match="is not the file of a search"):
            asked(out="x.h5", resume=True)
        assert journal.read_bytes().rstrip() == other.rstrip()


ODD = [
    '["identity"]',
    '"identity"',
    '{"identity": 3}',
    "3",
    "null",
    '{"of": "x", "trail": {}}',
    '{"of": []}',
    "[" * 9999,
    "\\xff",
]


def test_odd_lines_and_journals_that_were_joined(here):
    """Each line has its checksum: other programs can write that too."""

    def stop(start, _objective, _excess):
        if start == 1:
            raise KeyboardInterrupt

    assert asked(out="x.h5", progress=stop).stopped
    journal = here / "x.h5.journal"
    own = journal.read_bytes()
    odd = [text.encode() for text in ODD]
    odd = b"".join(b"%08x %b\n" % (zlib.crc32(text), text) for text in odd)
    journal.write_bytes(own + odd + own)
    assert asked(out="x.h5", resume=True).objective == asked().objective
    assert asked(out="x.h5", progress=stop, transmission=0.1, force=True).stopped
    journal.write_bytes(own + journal.read_bytes())
    with pytest.raises(
        StoreError, match=r"is of another search: transmission was 0\.1 and is 0\.05"
    ):
        asked(out="x.h5", resume=True)
    journal.write_bytes(odd)
    with pytest.raises(StoreError, match="is not the file of a search"):
        asked(out="x.h5", resume=True)


def test_nothing_is_left_of_a_mistake(here):
    with pytest.raises(PathError, match="does not exist"):
        asked(out="nowhere/x.h5")
    with pytest.raises(KeyboardInterrupt):
        asked(out="x.h5", starts=[{"T": 1.0}], progress=None, subject_to=Interrupting())
    assert not list(here.glob("x.*"))


class Interrupting(list):
    def __iter__(self):
        raise KeyboardInterrupt


def test_two_searches_do_not_write_one_file(here):
    def meanwhile(*_told):
        with pytest.raises(BusyError, match="another search is writing"):
            asked(out="x.h5", resume=True)
        raise KeyboardInterrupt

    asked(out="x.h5", progress=meanwhile)


FULL = """
import resource, sys
from pathlib import Path
sys.dont_write_bytecode = True
from lagrange_casadi.cli import main
for limit in (0, 100):
    resource.setrlimit(resource.RLIMIT_FSIZE, (limit, resource.RLIM_INFINITY))
    assert main({0!r}) == 1
    assert not list(Path().glob("x.h5*"))
"""


def test_a_full_disk_does_not_block_the_command_that_is_repeated(here):
    """Nothing of the journal's first line fits, or a part; the system's limit stands for the
    disk.
    """
    command = [sys.executable, "-c", FULL.format([*ASKED, "--out", "x.h5"])]
    for _ in range(2):
        with sweeps.process(*command, cwd=here) as full:
            err = full.communicate(timeout=60)[1]
        assert err == 2 * "error: cannot write x.h5.journal: File too large\n"
        assert full.returncode == 0


def test_an_empty_journal_is_of_no_search(here, whole):
    """A kill has left it, or the program that filled the disk."""
    journal_of(here / "x.h5").touch()
    assert main([*ASKED, "--out", "x.h5"]) in (0, 1)
    assert (here / "x.h5").read_bytes() == whole


def test_a_search_replaces_none_but_a_search(here, capfd):
    (here / "x.h5").write_text("mine")
    for more in ([], ["--force"]):
        assert main([*ASKED, "--out", "x.h5", *more]) == 2
        assert (
            capfd.readouterr().err
            == "error: cannot write x.h5: it is no file of HDF5; choose another name\n"
        )
        assert (here / "x.h5").read_text() == "mine"
