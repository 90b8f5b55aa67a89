"""The cache folder: within its limit, safe for many processes at once, and not shared with who may
not; and graphs that are derived once, named by all that they come from.
"""

import os
import pickle
import subprocess
import sys
import time

import casadi as ca
import numpy as np
import pytest
from every_way import DECLARED
from internals import Wanted, cache, identity_of
from mechanisms import slider_crank
from outside import doubled
from places import FOLDERS

from lagrange_casadi import Mechanism, Scene, derive, evaluate
from lagrange_casadi.cli import main
from lagrange_casadi.errors import PathError, PickleError
from lagrange_casadi.motion import Motion, expression, harmonic, polynomial, samples

NAMES = [f"{k:032x}" for k in range(12)]


def put(folder, name, size, age):
    """Something that was built, and last used so many seconds ago."""
    folder.mkdir(parents=True, exist_ok=True)
    for suffix, part in ((".c", size // 4), (".sha256", 64), (".so", size - size // 4 - 64)):
        file = folder / f"{name}{suffix}"
        file.write_bytes(b"x" * part)
        os.utime(file, (time.time() - age,) * 2)


def left(folder):
    return sorted({path.name.partition(".")[0] for path in folder.iterdir()})


def test_what_was_used_longest_ago_goes_first(fresh_cache, monkeypatch):
    monkeypatch.setenv(cache.VARIABLE, "5k")
    for k, name in enumerate(NAMES[:5]):
        put(fresh_cache, name, 1000, 1000 - k)
    cache.use(fresh_cache / f"{NAMES[0]}.so")
    cache.write(f"{NAMES[5]}.graph", "y" * 900)
    assert left(fresh_cache) == sorted([NAMES[0], *NAMES[2:6]])
    cache.write(f"{NAMES[6]}.graph", "y" * 2900)
    assert left(fresh_cache) == sorted([NAMES[0], *NAMES[5:7]])
    assert cache.read(f"{NAMES[6]}.graph") == "y" * 2900


def test_the_folder_is_looked_through_where_it_may_be_full_and_never_beyond_its_limit(
    fresh_cache, monkeypatch
):
    monkeypatch.setenv(cache.VARIABLE, "100k")
    entries, looked = cache.entries, []
    monkeypatch.setattr(cache, "entries", lambda place: looked.append(place) or entries(place))
    for k in range(120):
        cache.write(f"{k:032x}.graph", "y" * 935)
        assert sum(path.stat().st_size for path in fresh_cache.iterdir()) <= 100_000
        assert len(looked) < 60 or k > 90


@pytest.mark.parametrize(
    ("text", "says"), [("12", "1.2e-05"), ("1.5k", "0.0015"), ("2 GB", "2000"), ("1T", "1e+06")]
)
def test_the_limit_is_read_as_people_write_it(fresh_cache, monkeypatch, capsys, text, says):
    monkeypatch.setenv(cache.VARIABLE, text)
    assert main(["cache"]) == 0
    assert f"\nlimit: {says} MB, " in capsys.readouterr().out


@pytest.mark.parametrize("text", ["much", "-1", "1_0", "1e400", "5 apples", "nan", "..", "200m"])
def test_a_limit_that_is_none_is_refused(fresh_cache, monkeypatch, capsys, text):
    monkeypatch.setenv(cache.VARIABLE, text)
    assert main(["cache"]) == 2
    says = f"error: $LAGRANGE_CASADI_CACHE_SIZE = '{text}': expected bytes, as in 200000000, 200M"
    assert capsys.readouterr().err.startswith(says)


def test_a_limit_of_0_keeps_nothing(fresh_cache, monkeypatch):
    monkeypatch.setenv(cache.VARIABLE, "0")
    evaluate(slider_crank(["effort"]), backend="c")
    assert not fresh_cache.exists()


def test_a_folder_that_cannot_be_is_told(fresh_cache):
    fresh_cache.parent.mkdir(exist_ok=True)
    fresh_cache.write_text("a file")
    says = rf"cannot write into the cache folder {fresh_cache}: File exists; nothing is kept"
    with pytest.warns(UserWarning, match=says):
        assert cache.folder() is None


def test_what_is_not_ours_stays(fresh_cache, monkeypatch, capsys):
    put(fresh_cache, NAMES[0], 1000, 5)
    (fresh_cache / "notes.txt").write_text("mine")
    (fresh_cache / f"{NAMES[1]}.txt").write_text("mine too")
    assert main(["cache", "--clear"]) == 0
    assert f"{fresh_cache}: removed 0 graphs, 1 library, 0.001 MB\n" == capsys.readouterr().out
    assert left(fresh_cache) == [NAMES[1], "notes"]


def test_the_command_shows_what_is_kept(fresh_cache, monkeypatch, capsys):
    assert main(["cache"]) == 0
    assert (
        capsys.readouterr().out
        == f"{fresh_cache}: 0 graphs, 0 libraries, 0 MB in 0 files\nlimit: 500 MB, least"
        " recently used files are removed first; $LAGRANGE_CASADI_CACHE_SIZE sets another\n"
    )
    assert not fresh_cache.exists()
    put(fresh_cache, NAMES[0], 300_000, 5)
    put(fresh_cache, NAMES[1], 900_000, 5)
    cache.write(f"{NAMES[2]}-iterated.graph", "y" * 34_000)
    monkeypatch.setenv(cache.VARIABLE, "3M")
    assert main(["cache"]) == 0
    assert capsys.readouterr().out.startswith(
        f"{fresh_cache}: 1 graph, 2 libraries, 1.23 MB in 7 files\nlimit: 3 MB, "
    )


def owned_by_another(path, monkeypatch):
    """Let the system say that something belongs to somebody else."""
    lstat = os.lstat

    def told(other, *arguments, **keywords):
        found = list(lstat(other, *arguments, **keywords))
        if str(other) == str(path):
            found[4] = os.geteuid() + 1
        return os.stat_result(found)

    monkeypatch.setattr(os, "lstat", told)


@pytest.fixture
def foreign(request, fresh_cache, monkeypatch):
    """A cache folder into which others may put something, as did whoever planted a graph there."""
    monkeypatch.setattr(cache, "_is_own_group", lambda _: False)
    cache._usable.cache_clear()
    fresh_cache.mkdir(parents=True)
    (fresh_cache / f"{NAMES[0]}.graph").write_text(f"{cache.digest(b'planted')}\nplanted")
    place = {"folder": fresh_cache, "parent": fresh_cache.parent}[request.param[0]]
    if request.param[1] == "owner":
        owned_by_another(place, monkeypatch)
    else:
        place.chmod(request.param[1])
    yield place
    cache._usable.cache_clear()


WAYS = [
    (place, how) for place in ("folder", "parent") for how in (0o777, 0o775, 0o757, "owner")
] + [("folder", 0o1777)]


@pytest.mark.parametrize("foreign", WAYS, indirect=True)
def test_what_others_may_have_put_there_is_not_read(fresh_cache, foreign, capsys):
    why = rf"{foreign} belongs to another user|others may write into {foreign}"
    with pytest.warns(
        UserWarning,
        match=rf"^the cache folder {fresh_cache} is not used, because ({why}); a temporary one is$",
    ):
        own = cache.folder()
    assert own != fresh_cache
    assert own.stat().st_mode & 0o777 == 0o700
    assert cache.read(f"{NAMES[0]}.graph") is None
    cache.write(f"{NAMES[1]}.graph", "mine")
    assert cache.read(f"{NAMES[1]}.graph") == "mine"
    assert left(fresh_cache) == NAMES[:1]
    assert main(["cache"]) == 0
    assert capsys.readouterr().err.startswith(f"note: {fresh_cache} is not used, because ")


def test_nothing_is_built_where_others_may_change_it(fresh_cache, tmp_path, monkeypatch):
    shared = tmp_path / "shared"
    shared.mkdir()
    monkeypatch.setattr(cache.tempfile, "tempdir", str(shared))
    for mode, fits in ((0o777, False), (0o1777, True), (0o755, True)):
        shared.chmod(mode)
        if fits:
            with cache.working_folder() as work:
                assert work.parent == shared
            continue
        why = (
            rf"in the temporary folder {shared}, because others may write into .*; set \$TMPDIR to"
            r" a folder of your own$"
        )
        with pytest.raises(PathError, match=why), cache.working_folder():
            pass


def name_of(scene):
    return identity_of(scene, Wanted.of(scene.mechanism, scene.wanted))


def test_a_second_process_derives_nothing(fresh_cache, tmp_path):
    first = evaluate(slider_crank(), backend="c")
    program = (
        f"import sys; sys.path[:0] = {FOLDERS!r}; from mechanisms import"
        " slider_crank;"
        " __import__('importlib').import_module('lagrange_casadi.engine.derive').assemble ="
        " None; from lagrange_casadi import evaluate; print(evaluate(slider_crank(),"
        " backend='vm').effort('O').tobytes().hex())"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True, cwd=tmp_path
    )
    assert bytes.fromhex(done.stdout.strip()) == first.effort("O").tobytes()


def pendulum(
    length=0.5,
    mass=1.2,
    gravity=9.81,
    load=3.0,
    place=0.2,
    law=None,
    name="pendulum",
    wanted=("all",),
    **keywords,
):
    m = Mechanism(name)
    m.gravity = (0.0, -gravity, 0.0)
    k = m.parameter("k", 2.0, "N")
    arm = m.link("arm", length=length, mass=mass)
    pin = m.revolute("pin", m.ground, arm)
    m.force("push", arm.at(place), x=load * k * ca.sin(m.coordinate(pin)))
    return Scene(m, {"pin": law or polynomial(0.1, 2.0)}, wanted=wanted, **keywords)


UP = np.nextafter
CHANGES = [
    {"length": UP(0.5, 1)},
    {"mass": UP(1.2, 2)},
    {"gravity": UP(9.81, 10)},
    {"load": UP(3.0, 4)},
    {"place": UP(0.2, 1)},
    {"law": polynomial(0.1, UP(2.0, 3))},
    {"law": harmonic(0.1, 0.2, 0.3)},
    {"law": expression(lambda t: 0.1 + 2.0 * t * t)},
    {"law": samples([0, 1, 2, 3], [0, 1, 4, 2])},
    {"law": samples([0, 1, 2, 3], [0, 1, 4, UP(2.0, 3)])},
    {"name": "other"},
    {"wanted": ("effort",)},
    {"t": (UP(0.0, 1), 1.0, 101)},
    {"posture": {"arm": 0.3}},
]


def test_every_change_of_a_declaration_has_another_name():
    names = [name_of(pendulum()), *(name_of(pendulum(**change)) for change in CHANGES)]
    assert None not in names
    assert len(set(names)) == len(names)
    assert name_of(pendulum()) == names[0]


@pytest.mark.parametrize("name", DECLARED)
def test_the_same_declaration_has_the_same_name(name):
    first = name_of(DECLARED[name]())
    assert first is not None
    assert name_of(DECLARED[name]()) == first


DAMAGES = {
    "was damaged": lambda path, whole: path.write_bytes(whole[:-20]),
    r"was\ damaged": lambda path, whole: path.write_bytes(b"\xff" + whole),
    r"is not trusted \(others may write into .*\)": lambda path, whole: path.chmod(0o666),
}


@pytest.mark.parametrize("says", DAMAGES)
def test_a_damaged_graph_is_derived_again_and_said(fresh_cache, says):
    first = evaluate(pendulum(), backend="vm")
    (path,) = fresh_cache.glob("*.graph")
    whole = path.read_bytes()
    DAMAGES[says](path, whole)
    with pytest.warns(UserWarning, match=rf"the cached .*\.graph {says} and is made again"):
        again = evaluate(pendulum(), backend="vm")
    assert path.read_bytes() == whole
    assert np.array_equal(again.effort("pin"), first.effort("pin"))


def test_a_motion_by_a_callback_is_not_kept(fresh_cache, monkeypatch):
    monkeypatch.setattr("lagrange_casadi.engine.instants.refusing._SAMPLED", 41)
    scene = pendulum(law=Motion(doubled))
    assert name_of(scene) is None
    for _ in range(2):
        assert (
            evaluate(scene, backend="vm", wanted=["motion"], certificate=False)
            .motion("pin")
            .value[-1]
            == 2.0
        )
    assert not list(fresh_cache.glob("*.graph"))
    with pytest.raises(
        PickleError, match=r"the scene of '.*' cannot be pickled: it calls a function"
    ):
        pickle.dumps(derive(scene, ["motion"]))
