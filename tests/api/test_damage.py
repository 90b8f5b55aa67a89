"""Files damaged or forged at random, of every kind: each is refused in one line, and none crashes,
hangs, or is believed.
"""

import contextlib
import json
import os
import random
import re
import shutil
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest
import sweeps
from commands import command
from damaging import damaged
from forging import OWN, attributes, forging
from matplotlib.figure import Figure
from places import TESTS
from resealing import ONCE

from lagrange_casadi import Sweep, check, evaluate, load, optimise, read_designs, save, sweep
from lagrange_casadi.cli import main
from lagrange_casadi.errors import LagrangeCasadiError, StoreError

pytestmark = pytest.mark.filterwarnings("ignore::RuntimeWarning")  # of numbers beyond numbers

FEW, MANY, SEED = 12, 1000, "7"

ENDINGS = {"refused", "found", "accepted unchanged"}


def searched(out, **keywords):
    """A search of few designs."""
    over, words = {"T": (0.5, 2.0)}, {"starts": 3, "screen": 8, **keywords}
    return optimise(sweeps.turning(), minimise="peak:effort:O", over=over, out=out, **words)


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
    else:
        searched(path)
    return path


KINDS = ["run", "sweep", "search"]


READERS = {
    "run": (load, check, "info x.h5", "check x.h5", "plot x.h5 --out figures"),
    "sweep": (
        *(Sweep.open, "table x.h5 --csv x.csv", "best x.h5 --minimise peak:effort:O"),
        *("info x.h5", "check x.h5", "plot x.h5 --out figures"),
    ),
}


def told_by(read, capsys):
    """What a reader says of x.h5: its error, or nothing."""
    capsys.readouterr()
    if not isinstance(read, str):
        try:
            read(Path("x.h5"))
        except LagrangeCasadiError as error:
            return str(error)
        return ""
    status = command(read)
    out, err = capsys.readouterr()
    assert (not out and err.startswith("error: ")) or status == 0 or read.startswith("check")
    return (err or out) if status else ""


@pytest.mark.sampled(2)
@pytest.mark.parametrize("kind", READERS)
@pytest.mark.parametrize("count", [25, pytest.param(10_000, marks=pytest.mark.long)])
def test_damage_is_refused(here, slider_crank, monkeypatch, capsys, kind, count):
    """By every reader, in one line; all of them take the file as it was written."""
    monkeypatch.setattr(Figure, "savefig", lambda self, file, **_: Path(file).write_bytes(b"drawn"))
    file = source(kind, here, slider_crank, monkeypatch)
    content, chance = file.read_bytes(), random.Random(count)
    assert not any(told_by(read, capsys) for read in READERS[kind])
    for _ in range(count):
        wrong = damaged(content, chance)
        file.write_bytes(wrong)
        for read in READERS[kind]:
            assert bool(told := told_by(read, capsys)) is (wrong != content)
            assert "\n" not in told.rstrip("\n")


@pytest.mark.sampled(2)
@pytest.mark.skipif(not hasattr(os, "fork"), reason="each file is read in a fork")
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("count", [FEW, pytest.param(MANY, marks=pytest.mark.long)])
def test_damage_that_is_sealed_anew_is_noticed(tmp_path, slider_crank, monkeypatch, kind, count):
    """HDF5 sees it: no crash or hang passes unnoticed, and no reader raises what is not ours."""
    file, folder = source(kind, tmp_path, slider_crank, monkeypatch), tmp_path / "damaged"
    folder.mkdir()
    asked = [sys.executable, str(TESTS), "resealing", str(file), SEED, str(count)]
    # Each attempt has a limit of its own; this one is for what goes wrong besides.
    told = {"capture_output": True, "text": True, "timeout": 600 + 20.0 * count}
    done = subprocess.run(asked, cwd=folder, check=False, **told)
    assert (done.returncode, done.stderr) == (0, ""), done.stderr[-2000:]
    found = [line.partition(" ")[2] for line in done.stdout.splitlines()]
    assert len(found) == count
    assert not [word for word in found if word not in ENDINGS and not word.endswith(" told")]


def another(value):
    """A value that is not this one."""
    if isinstance(value, str):
        half = len(value) // 2
        return f"{value[:half]}{'a' if value[half : half + 1] != 'a' else 'b'}{value[half + 1 :]}"
    if isinstance(value, np.ndarray):
        return [another(value.tolist()[0]), *value.tolist()[1:]]
    return not value if isinstance(value, np.bool_) else value + 1 if np.isfinite(value) else 1.0


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("count", [FEW, pytest.param(None, marks=pytest.mark.long)])
def test_every_attribute_is_compared_with_something(
    tmp_path, slider_crank, monkeypatch, kind, count
):
    """Each alone is changed; those that may be believed are listed, with the reason."""
    file, believed = source(kind, tmp_path, slider_crank, monkeypatch), []
    with h5py.File(file) as h:
        told = [one for one in attributes(h) if one[1] not in {*OWN, *ONCE[h.attrs["schema"]]}]
    whole = file.read_bytes()
    for place, name, value in told if count is None else random.Random(1).sample(told, count):
        file.write_bytes(whole)
        with forging(file) as forged:
            forged[place].attrs[name] = another(value)
        if main(["check", str(file)]) == 0:
            believed.append((place, name))
    assert believed == []


WORDS = ("", "x", "3", "null", "[]", "{}", '{"a": 1}', "[" * 100_000, "1" * 5000, "\N{SNOWMAN}")
VALUES = (*WORDS, 3, -1.5, np.nan, np.arange(3), b"\xff\xfe", h5py.Empty("f8"), np.uint8(1))
VALUES += (np.array(["a", "b"], object),)
NODES = (None, True, 3, -1, 10**400, 0.5, float("nan"), "", "x", [], [None], {}, {"x": None})
NUMBERS = (1.0, np.nan, np.inf, 1e308, 1, np.float32(1), 1j, "x")
PYTHON = re.compile(
    r"zip\(\)|\.index\(|JSON object|object is not|has no attribute|ambiguous|could not convert"
)
"""Words of Python's own errors, which say nothing of a file."""


def another_tree(tree, chance):
    """A tree of JSON, of which a node is gone or something else."""
    copy, keys = tree.copy(), list(tree) if isinstance(tree, dict) else range(len(tree))
    if not keys or (key := chance.choice(keys)) is None:
        return chance.choice(NODES)
    if isinstance(tree[key], (dict, list)) and chance.random() < 0.7:
        copy[key] = another_tree(tree[key], chance)
    elif chance.random() < 0.1:
        del copy[key]
    else:
        copy[key] = chance.choice(NODES)
    return copy


def forge_attribute(h, place, chance):
    """Another value of an attribute of a place, or none."""
    name = chance.choice([name for name in h[place].attrs if name not in OWN])
    told, value = h[place].attrs[name], chance.choice(VALUES)
    if chance.random() < 0.1:
        del h[place].attrs[name]
    elif isinstance(told, str) and told[:1] in ("{", "[") and chance.random() < 0.8:
        h[place].attrs[name] = json.dumps(another_tree(json.loads(told), chance))
    else:
        h[place].attrs[name] = value


def forge_dataset(h, place, chance):
    """Other numbers in a dataset's place, none of the data, or data that are elsewhere."""
    shape, told = h[place].shape, dict(h[place].attrs)
    if chance.random() < 0.3:
        pipe = h5py.ExternalLink("pipe", "/x")
        del h[place]
        h[place] = chance.choice([h5py.SoftLink("/no"), h5py.SoftLink(f"/{place}"), pipe])
        return
    del h[place]
    if chance.random() < 0.2:
        return
    shape = chance.choice([shape, [n + 1 for n in shape], [0 for _ in shape], (*shape, 2), ()])
    huge = {"shape": (1 << 40,) * max(len(shape), 1), "dtype": float}
    piped = {"shape": shape, "dtype": float, "external": [("pipe", 0, 8 * max(shape, default=1))]}
    data = {"data": np.full(shape, chance.choice(NUMBERS))}
    new = h.create_dataset(place, **chance.choice([data, data, data, huge, piped]))
    for name in told.keys() - {*OWN}:
        new.attrs[name] = told[name]


@pytest.mark.sampled(3)
@pytest.mark.parametrize("count", [15, pytest.param(2000, marks=pytest.mark.long)])
@pytest.mark.parametrize("forge", [forge_attribute, forge_dataset])
@pytest.mark.parametrize("kind", ["run", "sweep", "list"])
def test_a_forged_file_is_one_line(here, slider_crank, monkeypatch, capsys, kind, forge, count):
    """Valid for HDF5 and JSON, and written by no run or sweep, whatever it holds: an error of ours
    is right, and so is a result. Whoever opened the pipe would wait for ever.
    """
    os.mkfifo("pipe")
    file, chance, done = source(kind, here, slider_crank, monkeypatch), random.Random(count), 0
    content, readers = file.read_bytes(), READERS["run" if kind == "run" else "sweep"]
    with h5py.File(file) as h:
        places = []
        h.visititems(lambda name, item: places.append(name) if hasattr(item, "shape") else None)
    while done < count:
        file.write_bytes(content)
        # HDF5 does not take everything.
        with contextlib.suppress(TypeError, ValueError, OSError, KeyError), forging(file) as h:
            forge(h, chance.choice(places if forge is forge_dataset else [*places, "/"]), chance)
            done += 1
        for read in readers if done % 10 == 0 else readers[:-1]:
            told = told_by(read, capsys)
            assert read.startswith("check") if "\n" in told.rstrip("\n") else True
            assert not PYTHON.search(told), told


def swept(out, **keywords):
    """A sweep of few designs, in blocks of five."""
    grid = {"l": (0.15, 0.4, 20), "r": [0.05, 0.1]}
    sweep(sweeps.scene(), grid, out=out, t=(0, 0.08, 7), workers=1, **keywords)


def stop_late(start, _objective, _excess):
    """What stops a search in its last run."""
    if start == 2:
        raise KeyboardInterrupt


@pytest.mark.parametrize("act", [swept, searched])
@pytest.mark.parametrize("count", [FEW, pytest.param(MANY, marks=pytest.mark.long)])
def test_what_is_damaged_of_an_unfinished_study_is_done_again(tmp_path, monkeypatch, act, count):
    """To the same bytes; of a damaged plan it is said that it is, and nothing is touched."""
    if act is swept:
        monkeypatch.setattr("lagrange_casadi.studies.sweep.columns._MOST", 5)
        sweeps.use(monkeypatch)
    out, folder, kept = tmp_path / "x.h5", tmp_path / "x.h5.parts", tmp_path / "kept"
    act(out)
    whole, chance = out.read_bytes(), random.Random(count)
    out.unlink()
    with contextlib.suppress(sweeps.StopError):
        act(out, progress=sweeps.stop_after(4) if act is swept else stop_late)
    out.unlink(missing_ok=True)
    shutil.copytree(folder, kept)
    names = sorted(path.name for path in kept.iterdir() if path.name != "lock")
    assert len(names) > 2
    for number in range(count):
        path, told = folder / names[number % len(names)], ""
        wrong = damaged(path.read_bytes(), chance)
        path.write_bytes(wrong)
        try:
            act(out, resume=True)
        except StoreError as error:
            told = str(error)
        if re.search("damaged: plan|is of another (sweep|search)", told):
            assert (path.name, path.read_bytes()) == ("plan.json", wrong)
            act(out, force=True)
        elif told:
            assert path.name != "plan.json"
            act(out, resume=True)
        assert (out.read_bytes(), folder.exists()) == (whole, False)
        out.unlink()
        shutil.copytree(kept, folder)
