"""Files that HDF5 and JSON find valid, and no run or sweep ever wrote: one line each, whatever they
hold.
"""

import hashlib
import itertools
import json
import os
import random
import re

import h5py
import numpy as np
import pytest
import sweeps
from forging import forging
from internals import (
    Folder,
    TimePlot,
    check_shape,
    check_sweep,
    dump_specs,
    parse_specs,
    progress,
    reported_as,
    sweep,
)
from internals import ListingListed as Listed
from internals import runs as store
from internals import untrusted_parsed as parsed

from lagrange_casadi import Sweep, best, check, evaluate, load, save
from lagrange_casadi.cli import main
from lagrange_casadi.errors import DeclarationError, LagrangeCasadiError, StoreError

pytestmark = pytest.mark.filterwarnings("ignore::RuntimeWarning")  # of numbers beyond numbers

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


def attributes(path):
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


@pytest.fixture
def run(slider_crank, here):
    solution = evaluate(
        slider_crank.scene,
        t=(0, 0.08, 5),
        xi=(0, 1, 3),
        wanted=("effort", "section:rod", "motion"),
        backend="vm",
    )
    save(solution, here / "x.h5", dump_specs([TimePlot("effort", ("effort:O",))]))
    return here / "x.h5"


@pytest.fixture(params=["grid", "list"])
def swept(request, monkeypatch, here):
    sweeps.use(monkeypatch)
    rows = np.array([[0.1, 0.2], [0.15, 0.3], [0.2, 0.25]])
    designs = (
        {"l": [0.2, 0.3], "r": [0.05, 0.1, 0.07]}
        if request.param == "grid"
        else Listed(("l", "r"), rows)
    )
    return sweep(sweeps.scene(), designs, out=here / "x.h5", xi=(0, 1, 3), keep="histories").path


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


RUN = (load, check, store.figure_specs, commanded("info", "FILE"), commanded("check", "FILE"))
SWEEP = (
    all_of,
    check_sweep,
    commanded("info", "FILE"),
    commanded("check", "FILE"),
    commanded("table", "FILE", "--csv", "x.csv"),
    commanded(
        "best", "FILE", "--minimise", "peak:effort:O", "--maximise", "peak:section:rod:shear"
    ),
)
DRAWN = commanded("plot", "FILE", "--out", "figures")


def assert_one_line(file, fifo, capsys, kind, long, commands, drawn):
    """Every forgery is tried, and what takes long with one in so many as ``drawn`` says."""
    forgeries = attributes(file) if kind == "attributes" else datasets(file, fifo)
    for number, (word, change) in enumerate(chosen(forgeries, long)):
        try:
            attempt(file, change, commands if number % drawn else (*commands, DRAWN))
        except Exception as error:
            error.add_note(word) if hasattr(error, "add_note") else print(word)
            raise
    assert "Traceback" not in "".join(capsys.readouterr())


@pytest.mark.sampled(5)
@pytest.mark.parametrize("kind", ["attributes", "datasets"])
@pytest.mark.parametrize("long", [False, pytest.param(True, marks=pytest.mark.long)])
def test_a_forged_run_is_one_line(run, fifo, capsys, kind, long):
    assert_one_line(run, fifo, capsys, kind, long, RUN, 10)


@pytest.mark.sampled(9)
@pytest.mark.parametrize("kind", ["attributes", "datasets"])
@pytest.mark.parametrize("long", [False, pytest.param(True, marks=pytest.mark.long)])
def test_a_forged_sweep_is_one_line(swept, fifo, capsys, kind, long):
    assert_one_line(swept, fifo, capsys, kind, long, SWEEP, 30)


@pytest.mark.parametrize(
    ("value", "shape", "place"),
    [
        (3, int, ""),
        (True, int, "it"),
        (3, float, ""),
        (True, float, "it"),
        (10**400, float, "it"),
        (float("inf"), float, ""),
        ("x", str, ""),
        ("\ud800", str, "it"),
        (None, (str, None), ""),
        (3, (str, None), "it"),
        ([1, 2, 3], [int], ""),
        ([], [int], ""),
        ([1, "2"], [int], "it[1]"),
        ({}, [int], "it"),
        ([0.5, 1, 3], [float, float, int], ""),
        ([0.5, 1, 3.5], [float, float, int], "it[2]"),
        ([0.5, 1], [float, float, int], "it"),
        ({"a": {"b": [1]}}, {str: {"b": [int]}}, ""),
        ({"a": {"b": [None]}}, {str: {"b": [int]}}, "it.a.b[0]"),
        ({"a": 1, "more": None}, {"a": int}, ""),
        ({"more": None}, {"a": int}, "it.a"),
        ([], {"a": int}, "it"),
        ({}, {}, ""),
        ({"length": None}, ({"length": None}, {"length": float, "mass": float}), ""),
        ({"length": 1.0}, ({"length": None}, {"length": float, "mass": float}), "it"),
    ],
)
def test_a_shape_names_the_place_that_it_does_not_fit(value, shape, place):
    if not place:
        assert parsed(json.dumps({"it": value}), {"it": shape}) is not None
        return
    with pytest.raises(ValueError, match=rf"^{re.escape(place)} is not of the expected kind$"):
        check_shape(value, shape, "it")


def test_what_is_no_error_of_ours_becomes_one():
    def fail(error):
        with reported_as("damaged", "x.h5"):
            raise error

    with pytest.raises(StoreError, match=r"^x\.h5: damaged: two lines$"):
        fail(ValueError("two\nlines"))
    with pytest.raises(StoreError, match=r"^x\.h5: damaged: ZeroDivisionError$"):
        fail(ZeroDivisionError())
    for error in (DeclarationError("mine"), MemoryError(), KeyboardInterrupt()):
        with pytest.raises(type(error)):
            fail(error)


FIGURES = (
    "{",
    "3",
    "{}",
    "[3]",
    '["time"]',
    '[{"kind": "time"}]',
    '[{"kind": "x", "name": "a"}]',
    '[{"kind": "time", "name": "a"}]',
    '[{"kind": "time", "name": "a", "quantities": [], "more": 1}]',
    '[{"kind": 3, "name": "a"}]',
    "[" * 100_000,
)


@pytest.mark.parametrize("text", FIGURES)
def test_figures_that_are_none_are_one_line(text):
    with pytest.raises(StoreError, match=r"^the file's attribute 'figures' is damaged: .*$"):
        parse_specs(text)


def test_a_forged_plan_is_one_line(here, capsys):
    plan = sweeps.identity()
    folder = Folder(here / "x.h5")
    with folder.locked():
        folder.begin(plan)
        for text in [*WORDS, *map(json.dumps, replaced(plan))]:
            (folder.path / "plan.json").write_text(text)
            for command in ("info", "check"):
                assert main([command, "x.h5.parts"]) in (0, 1), text
                assert capsys.readouterr().err.count("\n") <= 1, text
        for text in (*WORDS, '{"grid": 3}'):
            (folder.path / "plan.json").write_text(text)
            with pytest.raises(
                StoreError, match=r"plan\.json: damaged: .*; start anew with force=True$"
            ):
                progress(folder)


@pytest.mark.long
@pytest.mark.parametrize("long", [False, pytest.param(True, marks=pytest.mark.long)])
def test_a_forged_part_is_done_again(monkeypatch, here, long):
    """Whatever the head of a part says, with a digest that fits, the file is the one that there
    would have been.
    """
    sweeps.use(monkeypatch)
    grid = {"l": [0.2, 0.3], "r": [0.05, 0.1, 0.07]}
    whole = sweep(sweeps.scene(), grid, out=here / "whole.h5").path.read_bytes()
    identity, folder = dict(Sweep.open(here / "whole.h5").identity), Folder(here / "x.h5")
    head = {"start": 0, "stop": 6, "columns": {"status": [6, 0]}}
    names = itertools.cycle(
        ["000000000000-000000000006", "000000000000-000000000003", "000000000002-000000000006"]
    )
    forged = chosen(map(json.dumps, replaced(head)), long)
    for text in [*WORDS, *map(json.dumps, [head, {**head, "stop": 10**30}, identity]), *forged]:
        digest = hashlib.sha256(text.encode()).hexdigest()
        with folder.locked():
            folder.begin(identity)
            (folder.path / f"{next(names)}.part").write_bytes(
                f"{text}\n{digest}\n".encode() + b"status"
            )
        assert folder.done() in (0, 3, 4, 6)
        assert all("\n" not in flaw for flaw in folder.flaws())
        found = sweep(sweeps.scene(), grid, out=folder.target, resume=True)
        assert found.path.read_bytes() == whole, text
        found.path.unlink()
