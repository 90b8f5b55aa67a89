"""Files damaged or forged at random, of every kind: each is refused in one line, and none crashes,
hangs, or is believed.
"""

import json
import os
import random
import re
import subprocess
import sys
import zlib

import h5py
import numpy as np
import pytest
import sweeps
from forging import forging
from places import TESTS
from resealing import LISTS, ONCE

from lagrange_casadi import (
    Mechanism,
    Scene,
    Sweep,
    best,
    check,
    evaluate,
    load,
    optimise,
    read_designs,
    save,
    sweep,
)
from lagrange_casadi.cli import main
from lagrange_casadi.errors import LagrangeCasadiError, PathError, StoreError
from lagrange_casadi.motion import polynomial

pytestmark = pytest.mark.filterwarnings("ignore::RuntimeWarning")  # of numbers beyond numbers

FEW, MANY, SEED = 12, 1000, "7"

ENDINGS = {"refused", "found", "accepted unchanged"}


def searched(out, **keywords):
    """A search of few designs."""
    m = Mechanism("turning")
    duration = m.parameter("T", 1.0, "s", low=0.01)
    m.revolute("O", m.ground, m.link("rod", length=0.3, mass=1.0))
    scene = Scene(m, {"O": polynomial(0.0, 1.0, duration)}, t=(0, duration, 11), wanted=["effort"])
    return optimise(
        scene,
        minimise="peak:effort:O",
        over={"T": (0.5, 2.0)},
        starts=3,
        screen=8,
        backend="vm",
        out=out,
        **keywords,
    )


def source(kind, folder, slider_crank, monkeypatch):
    """A file that is whole."""
    path = folder / "x.h5"
    if kind == "run":
        save(
            evaluate(
                slider_crank.scene,
                t=(0, 0.08, 5),
                xi=(0, 1, 3),
                wanted=("effort", "section:rod"),
                backend="vm",
            ),
            path,
        )
    elif kind in ("sweep", "list"):
        sweeps.use(monkeypatch)
        (folder / "d.csv").write_text("l,r\n0.1,0.2\n0.15,0.3\n0.2,0.25\n")
        grid = {"l": [0.2, 0.3], "r": [0.05, 0.1, 0.07]}
        sweep(
            sweeps.scene(),
            grid if kind == "sweep" else read_designs(folder / "d.csv"),
            out=path,
            xi=(0, 1, 3),
            keep="histories",
        )
    elif kind == "search":
        searched(path)
    else:

        def stop(start, _objective, _excess):
            if start == 2:
                raise KeyboardInterrupt

        searched(path, progress=stop)
        return path.with_name("x.h5.journal")
    return path


KINDS = ["run", "sweep", "search", "journal"]
_SECONDS = 20.0


def program(name, file, folder, seed, count):
    """What a program that damages a file says, a line each, after its number."""
    folder.mkdir()
    command = [sys.executable, str(TESTS), name, str(file), str(seed), str(count)]
    # Each attempt has a limit of its own; this one is for what goes wrong besides.
    limit = 600 + _SECONDS * count
    done = subprocess.run(
        command, cwd=folder, capture_output=True, text=True, timeout=limit, check=False
    )
    assert (done.returncode, done.stderr) == (0, ""), done.stderr[-2000:]
    return done.stdout.splitlines()


@pytest.mark.sampled(2)
@pytest.mark.parametrize("kind", ["run", "sweep"])
@pytest.mark.parametrize("count", [120, pytest.param(10_000, marks=pytest.mark.long)])
def test_damage_is_refused(tmp_path, slider_crank, monkeypatch, kind, count):
    """The same program finds that every reader takes the file as it was written."""
    file = source(kind, tmp_path, slider_crank, monkeypatch)
    *accepted, _ = program("damaging", file, tmp_path / "whole", 0, 0)
    readers = range(6 if kind == "run" else 7)
    assert accepted == ["0", *(f"0: {number}: accepted" for number in readers)]
    lines = program("damaging", file, tmp_path / "damaged", 1, count)
    assert lines == [str(number) for number in range(count)]


@pytest.mark.sampled(2)
@pytest.mark.skipif(not hasattr(os, "fork"), reason="each file is read in a fork")
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("count", [FEW, pytest.param(MANY, marks=pytest.mark.long)])
def test_damage_that_is_sealed_anew_is_noticed(tmp_path, slider_crank, monkeypatch, kind, count):
    """HDF5 sees it: no crash or hang passes unnoticed, and no reader raises what is not ours."""
    file = source(kind, tmp_path, slider_crank, monkeypatch)
    lines = program("resealing", file, tmp_path / "damaged", SEED, count)
    found = [line.partition(" ")[2] for line in lines]
    assert len(found) == count
    # A search that was killed may have lost the last lines of its journal.
    endings = ENDINGS | ({"accepted"} if kind == "journal" else set())
    assert not [word for word in found if word not in endings and not word.endswith(" told")]


def attributes(file):
    """All attributes of a file, by place and name."""
    found = {}
    with h5py.File(file) as whole:
        places = ["/"]
        whole.visit(places.append)
        for place in places:
            found |= {
                (place, name): value
                for name, value in whole[place].attrs.items()
                if name not in (*LISTS, "CLASS", "NAME")
            }
    return found


def another(value):
    """A value that is not this one."""
    if isinstance(value, str):
        half = len(value) // 2
        return f"{value[:half]}{'a' if value[half : half + 1] != 'a' else 'b'}{value[half + 1 :]}"
    if isinstance(value, np.ndarray):
        return [another(value.tolist()[0]), *value.tolist()[1:]]
    return not value if isinstance(value, np.bool_) else value + 1 if np.isfinite(value) else 1.0


SCHEMAS = {"run": "", "sweep": "-sweep", "search": "-optimum"}


@pytest.mark.parametrize("kind", SCHEMAS)
@pytest.mark.parametrize("count", [FEW, pytest.param(None, marks=pytest.mark.long)])
def test_every_attribute_is_compared_with_something(
    tmp_path, slider_crank, monkeypatch, kind, count
):
    """Each alone is changed; those that may be believed are listed, with the reason."""
    file, believed = source(kind, tmp_path, slider_crank, monkeypatch), []
    with h5py.File(file) as told:
        once = ONCE[told.attrs["schema"]]
    whole = file.read_bytes()
    told = [place for place in attributes(file).items() if place[0][1] not in once]
    for (place, name), value in told if count is None else random.Random(1).sample(told, count):
        file.write_bytes(whole)
        with forging(file) as forged:
            forged[place].attrs[name] = another(value)
        if main(["check", str(file)]) == 0:
            believed.append((place, name))
    assert believed == []


SOME, MANY = 15, 2000
"""Forgeries of each kind that the ordinary lane tries, and the long one."""

WORDS = ("", "x", "3", "null", "[]", "{}", '{"a": 1}', "[" * 100_000, "1" * 5000, "\N{SNOWMAN}")

VALUES = (
    *WORDS,
    3,
    -1.5,
    np.nan,
    np.arange(3),
    np.array(["a", "b"], object),
    b"\xff\xfe",
    h5py.Empty("f8"),
    np.uint8(1),
)

PYTHON = re.compile(
    r"zip\(\)|\.index\(|JSON object|object is not|has no attribute|ambiguous|could not convert"
)
"""Words of Python's own errors, which say nothing of a file."""

NODES = (None, True, 3, -1, 10**400, 0.5, float("nan"), "", "x", [], [None], {}, {"x": None})


def replaced(tree):
    """A tree of JSON, with each node in turn gone or something else."""
    for key in list(tree) if isinstance(tree, dict) else range(len(tree)):
        for other in NODES:
            copy = tree.copy()
            copy[key] = other
            yield copy
        copy = tree.copy()
        del copy[key]
        yield copy
        if isinstance(tree[key], (dict, list)):
            for below in replaced(tree[key]):
                copy = tree.copy()
                copy[key] = below
                yield copy


def forged_attributes(path):
    """Every attribute of a file gone or something else, and what is JSON with
    every node of it so.
    """
    with h5py.File(path) as file:
        places = ["/"]
        file.visit(places.append)
        for place in places:
            for name in file[place].attrs:
                if name in ("CLASS", "NAME", "DIMENSION_LIST", "REFERENCE_LIST"):
                    continue
                yield (
                    f"{place} {name} gone",
                    lambda h, place=place, name=name: h[place].attrs.__delitem__(name),
                )
                for value in VALUES:
                    yield (
                        f"{place} {name} {value!r:.40}",
                        lambda h, p=place, n=name, v=value: h[p].attrs.__setitem__(n, v),
                    )
                told = file[place].attrs[name]
                if isinstance(told, str) and told[:1] in ("{", "["):
                    for tree in replaced(json.loads(told)):
                        text = json.dumps(tree)
                        yield (
                            f"{place} {name} {text:.40}",
                            lambda h, p=place, n=name, v=text: h[p].attrs.__setitem__(n, v),
                        )


def put(h, place, **keywords):
    """Another dataset in a place, with the attributes of the one that was there."""
    old = dict(h[place].attrs)
    del h[place]
    new = h.create_dataset(place, **keywords)
    for name in set(old) - {"DIMENSION_LIST", "REFERENCE_LIST", "CLASS", "NAME"}:
        new.attrs[name] = old[name]
    return new


def elsewhere(h, place, link):
    del h[place]
    h[place] = link


def others(shape, fifo):
    """What may stand in a dataset's place: other shapes and types, none of the data, or data that
    are elsewhere.
    """
    layout = h5py.VirtualLayout(shape, float)
    layout[...] = h5py.VirtualSource(str(fifo), "x", shape)

    def virtual(h, place):
        del h[place]
        h.create_virtual_dataset(place, layout)

    yield "gone", lambda h, place: h.__delitem__(place)
    yield "elsewhere", lambda h, place: h.move(place, f"x/{place}")
    yield "a group", lambda h, place: (h.__delitem__(place), h.create_group(place))
    yield "a soft link", lambda h, place: elsewhere(h, place, h5py.SoftLink("/nowhere"))
    yield "a link to itself", lambda h, place: elsewhere(h, place, h5py.SoftLink(f"/{place}"))
    yield (
        "a link to a pipe",
        lambda h, place: elsewhere(h, place, h5py.ExternalLink(str(fifo), "/x")),
    )
    yield "virtual", virtual
    yield (
        "in a pipe",
        lambda h, place: put(
            h, place, shape=shape, dtype=float, external=[(str(fifo), 0, 8 * max(shape, default=1))]
        ),
    )
    yield (
        "not there",
        lambda h, place: put(h, place, shape=shape, dtype=float, chunks=shape or None),
    )
    yield (
        "enormous",
        lambda h, place: put(
            h, place, shape=(1 << 40,) * max(len(shape), 1), dtype=float, chunks=(1,) * len(shape)
        ),
    )
    kinds = {
        "a number": 1.0,
        "nothing": h5py.Empty("f8"),
        "words": np.full(shape, "x", object),
        "pairs": np.zeros(shape, [("a", float)]),
        "complex": np.zeros(shape, complex),
        "whole numbers": np.ones(shape, int),
        "singles": np.ones(shape, np.float32),
        "not numbers": np.full(shape, np.nan),
        "infinite": np.full(shape, np.inf),
        "beyond numbers": np.full(shape, 1e308),
        "longer": np.zeros([n + 1 for n in shape]),
        "empty": np.zeros([0 for _ in shape]),
        "flat": np.zeros(int(np.prod(shape))),
        "deeper": np.zeros((*shape, 2)),
    }
    for word, data in kinds.items():
        yield word, lambda h, place, data=data: put(h, place, data=data)


def datasets(path, fifo):
    """Every dataset of a file something else."""
    with h5py.File(path) as file:
        found = {}
        file.visititems(
            lambda place, item: (
                found.update({place: item.shape}) if isinstance(item, h5py.Dataset) else None
            )
        )
    for place, shape in found.items():
        for word, change in others(shape, fifo):
            yield f"{place} {word}", lambda h, change=change, place=place: change(h, place)


def chosen(forgeries, long):
    """Some of them, or many."""
    every = list(forgeries)
    return random.Random(1).sample(every, min(MANY if long else SOME, len(every)))


def attempt(path, change, readers):
    """Forge, and read in every way; an error of ours is right, and so is a result."""
    original = path.read_bytes()
    try:
        with forging(path) as h:
            change(h)
    except (TypeError, ValueError, OSError, KeyError):  # HDF5 does not take it
        return
    finally:
        forged = path.read_bytes()
        path.write_bytes(original)
    path.write_bytes(forged)
    try:
        for read in readers:
            try:
                read(path)
            except LagrangeCasadiError as error:
                told = str(error)
            else:
                told = ""
            assert "\n" not in told
            assert not PYTHON.search(told), told
    finally:
        path.write_bytes(original)


def commanded(*arguments):
    """A command of the command line, which turns errors of ours into a status; anything else is
    raised.
    """
    return lambda path: main([str(path) if word == "FILE" else word for word in arguments])


@pytest.fixture(scope="module")
def fifo(tmp_path_factory):
    """A pipe that nobody writes to: whoever opens it waits for ever."""
    path = tmp_path_factory.mktemp("pipe") / "pipe"
    os.mkfifo(path)
    return path


def all_of(path):
    """Everything that can be read of a sweep."""
    found = Sweep.open(path)
    for name in (*found.columns, *found.parameters, "t", "xi"):
        assert found[name].size
    for _ in found.blocks(
        [*found.parameters, *(name for name, kept in found.columns.items() if not kept.axes)]
    ):
        pass
    repr(found)
    found.counts()
    found.design(1)
    found.to_xarray()
    best(found, minimise="peak:effort:O", where="l>0.1")


RUN = (load, check, commanded("info", "FILE"), commanded("check", "FILE"))

SWEEP = (
    all_of,
    commanded("check", "FILE"),
    commanded("info", "FILE"),
    commanded("check", "FILE"),
    commanded("table", "FILE", "--csv", "x.csv"),
    commanded(
        "best", "FILE", "--minimise", "peak:effort:O", "--maximise", "peak:section:rod:shear"
    ),
)

DRAWN = commanded("plot", "FILE", "--out", "figures")


@pytest.mark.sampled(3)
@pytest.mark.parametrize("long", [False, pytest.param(True, marks=pytest.mark.long)])
@pytest.mark.parametrize("of", ["attributes", "datasets"])
@pytest.mark.parametrize("kind", ["run", "sweep", "list"])
def test_a_forged_file_is_one_line(here, slider_crank, monkeypatch, fifo, capsys, kind, of, long):
    """Valid for HDF5 and JSON, and written by no run or sweep, whatever it holds."""
    file = source(kind, here, slider_crank, monkeypatch)
    forgeries = forged_attributes(file) if of == "attributes" else datasets(file, fifo)
    readers, drawn = (RUN, 10) if kind == "run" else (SWEEP, 30)
    for number, (word, change) in enumerate(chosen(forgeries, long)):
        try:
            attempt(file, change, readers if number % drawn else (*readers, DRAWN))
        except Exception as error:
            error.add_note(word) if hasattr(error, "add_note") else print(word)
            raise
    assert "Traceback" not in "".join(capsys.readouterr())


ODD = ['{"identity": 3}', "3", '{"of": "x", "trail": {}}', '{"of": []}', "[" * 9999, "\\xff"]


def test_a_journal_is_gone_on_with_or_refused(tmp_path, slider_crank, monkeypatch):
    """Cut anywhere in its first line it holds nothing; lines that are odd or damaged are done
    again; what no search wrote is left alone.
    """
    journal = source("journal", tmp_path, slider_crank, monkeypatch)
    own, out = journal.read_bytes(), tmp_path / "x.h5"
    first, second, *rest = own.splitlines(keepends=True)
    searched(tmp_path / "whole.h5")
    whole = (tmp_path / "whole.h5").read_bytes()
    odd = b"".join(b"%08x %b\n" % (zlib.crc32(t), t) for t in map(str.encode, ODD))
    damaged = second.replace(b"1", b"7", 1)
    for content in (b"", first[:9], first[:100], own + odd + own, first + damaged + b"".join(rest)):
        journal.write_bytes(content)
        searched(out, resume=True)
        assert out.read_bytes() == whole
        assert not journal.exists()
        out.unlink()
    for content in (b"notes", first[:20] + b"\n", first[1:], odd):
        journal.write_bytes(content)
        with pytest.raises(StoreError, match="is not the file of a search"):
            searched(out, resume=True)
        with pytest.raises(PathError, match="is of an unfinished search"):
            searched(out)
        assert journal.read_bytes().rstrip() == content.rstrip()
