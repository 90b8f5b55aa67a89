"""Damage that a new seal hides is seen by HDF5: no crash or hang passes unnoticed, and no reader
raises what is not ours.
"""

import os
import random
import subprocess
import sys
from collections import Counter

import h5py
import numpy as np
import pytest
import sweeps
from forging import edit, forging
from internals import kind_of, sweep
from places import TESTS
from resealing import LISTS, ONCE

from lagrange_casadi import Mechanism, Scene, evaluate, optimise, save
from lagrange_casadi.cli import main
from lagrange_casadi.motion import polynomial

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
    elif kind == "sweep":
        sweeps.use(monkeypatch)
        sweep(
            sweeps.scene(),
            {"l": [0.2, 0.3], "r": [0.05, 0.1, 0.07]},
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


@pytest.mark.sampled(2)
@pytest.mark.skipif(not hasattr(os, "fork"), reason="each file is read in a fork")
@pytest.mark.parametrize("kind", ["run", "sweep", "search", "journal"])
@pytest.mark.parametrize("count", [FEW, pytest.param(MANY, marks=pytest.mark.long)])
def test_damage_that_is_sealed_anew_is_noticed(tmp_path, slider_crank, monkeypatch, kind, count):
    file = source(kind, tmp_path, slider_crank, monkeypatch)
    folder = tmp_path / "damaged"
    folder.mkdir()
    command = [sys.executable, str(TESTS), "resealing", str(file), SEED, str(count)]
    done = subprocess.run(
        command, cwd=folder, capture_output=True, text=True, timeout=600 + 3 * count, check=False
    )
    assert done.returncode == 0, done.stderr[-2000:]
    found = [line.partition(" ")[2] for line in done.stdout.splitlines()]
    assert len(found) == count
    print(kind, Counter(found))
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


@pytest.mark.parametrize("kind", ["run", "sweep", "search"])
@pytest.mark.parametrize("count", [FEW, pytest.param(None, marks=pytest.mark.long)])
def test_every_attribute_is_compared_with_something(
    tmp_path, slider_crank, monkeypatch, kind, count
):
    """Each alone is changed; those that may be believed are listed, with the reason."""
    file = source(kind, tmp_path, slider_crank, monkeypatch)
    whole, once, believed = file.read_bytes(), ONCE[kind_of(file)], []
    told = [place for place in attributes(file).items() if place[0][1] not in once]
    for (place, name), value in told if count is None else random.Random(1).sample(told, count):
        file.write_bytes(whole)
        with forging(file) as forged:
            forged[place].attrs[name] = another(value)
        if main(["check", str(file)]) == 0:
            believed.append((place, name))
    assert believed == []


def renamed(attributes, old, new):
    attributes[new] = attributes[old]
    del attributes[old]


CHANGES = {
    "run": [
        lambda file: file["t"].write_direct(np.full(5, np.nan)),
        lambda file: renamed(file["section/rod/law/m0"].attrs, "error_estimate", "error_es+imate"),
        lambda file: file.attrs.__setitem__(
            "parameters", file.attrs["parameters"].replace("0.2", "0.3")
        ),
        lambda file: file.attrs.__setitem__(
            "parameters", file.attrs["parameters"].replace(' "', ' `"')
        ),
        lambda file: file.attrs.__setitem__(
            "mechanism", file.attrs["mechanism"].replace('"body": "slider"', '"body": "sli`er"')
        ),
        lambda file: file["t"].attrs.__setitem__("units", "ms"),
    ],
    "sweep": [lambda file: file["grid/l"].write_direct(np.array([0.2, np.nan]))],
    "search": [
        lambda file: file["starts/1/start"].write_direct(np.array([0.0])),
        lambda file: file["starts/0"].attrs.__setitem__("objective", 1.6),
        lambda file: file["starts/2"].attrs.__setitem__("ending", "conv\x01rged"),
        lambda file: file["history"].attrs.__setitem__(
            "columns", ["start", "ocjective", "excess", "result", "T"]
        ),
        lambda file: file["optima/designs"].write_direct(np.array([[0.6]])),
        lambda file: renamed(file["starts/1"].attrs, "objective", "ocjective"),
    ],
}


@pytest.mark.parametrize("kind", CHANGES)
def test_what_is_told_twice_is_compared(tmp_path, slider_crank, monkeypatch, kind):
    """What was accepted among some thousands of damaged files."""
    file = source(kind, tmp_path, slider_crank, monkeypatch)
    command = ["check", str(file)]
    whole = file.read_bytes()
    assert main(command) == 0
    for change in CHANGES[kind]:
        file.write_bytes(whole)
        edit(file, change)
        assert main(command) == 1
