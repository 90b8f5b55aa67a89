"""The cache folder: whole or not there, within its limit, and safe for many processes at once."""

import os
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor

import pytest
import sweeps
from internals import backends, cache
from places import FOLDERS

from lagrange_casadi import evaluate
from lagrange_casadi.cli import main
from lagrange_casadi.errors import DeclarationError, PathError

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


@pytest.mark.parametrize(
    ("text", "size"),
    [
        ("", cache.LIMIT),
        ("12", 12),
        ("1.5k", 1500),
        ("200M", 200_000_000),
        ("2 GB", 2 * 10**9),
        ("1T", 10**12),
    ],
)
def test_the_limit_is_read_as_people_write_it(monkeypatch, text, size):
    monkeypatch.setenv(cache.VARIABLE, text)
    assert cache.limit() == size


@pytest.mark.parametrize("text", ["much", "-1", "1_0", "1e400", "5 apples", "nan", "..", "200m"])
def test_a_limit_that_is_none_is_refused(monkeypatch, text):
    monkeypatch.setenv(cache.VARIABLE, text)
    with pytest.raises(
        DeclarationError,
        match=r"\$LAGRANGE_CASADI_CACHE_SIZE = .*: expected bytes, as in 200000000, 200M or 2G",
    ):
        cache.limit()


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
    monkeypatch.setenv(cache.VARIABLE, "x")
    assert main(["cache"]) == 2
    assert capsys.readouterr().err.startswith(
        "error: $LAGRANGE_CASADI_CACHE_SIZE = 'x': expected bytes"
    )


def test_many_at_once_keep_within_the_limit(fresh_cache, monkeypatch):
    """Some write, some read, some clear: what is read is whole or not there, and nobody fails."""
    monkeypatch.setenv(cache.VARIABLE, "6k")

    def work(k):
        for turn in range(30):
            name = f"{NAMES[(k + turn) % len(NAMES)]}.graph"
            if k % 4 == 3:
                cache.remove(cache.entries(cache.folder()).values())
            elif k % 2:
                assert cache.read(name) in (None, "y" * 1000)
            else:
                cache.write(name, "y" * 1000)

    with ThreadPoolExecutor(8) as pool:
        list(pool.map(work, range(8)))
    cache.write(f"{NAMES[0]}.graph", "y")
    assert sum(entry.size for entry in cache.entries(fresh_cache).values()) <= 6000


PROGRAM = """
import sys
sys.path[:0] = {folders!r}
import threaded
from lagrange_casadi import evaluate
for own in range(3):
    evaluate(threaded.press(own), backend="c", flags="-O0", t=(0, 1, 9), certificate=False)
"""


@pytest.mark.long
def test_processes_share_a_cache_that_holds_too_little(tmp_path):
    """Each removes what another one is about to load."""
    command = [sys.executable, "-W", "error", "-c", PROGRAM.format(folders=FOLDERS)]
    environment = {**os.environ, "XDG_CACHE_HOME": str(tmp_path), cache.VARIABLE: "60k"}
    started = [
        subprocess.Popen(command, env=environment, stderr=subprocess.PIPE, text=True)
        for _ in range(3)
    ]
    assert [(process.communicate(timeout=120)[1], process.returncode) for process in started] == [
        ("", 0)
    ] * 3


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


@pytest.mark.parametrize(
    "foreign", [("parent", 0o1777), ("parent", 0o755), ("folder", 0o700)], indirect=True
)
def test_a_folder_like_tmp_may_lead_there(fresh_cache, foreign):
    assert cache.folder() == fresh_cache
    assert cache.read(f"{NAMES[0]}.graph") == "planted"


@pytest.mark.parametrize("backend", ["c", "lanes"])
def test_a_library_that_others_may_write_is_built_again(fresh_cache, backend):
    """A planted one would run, for its digest beside it fits."""
    evaluate(sweeps.scene(), backend=backend, flags="-O0")
    libraries = list(fresh_cache.glob("*.so"))
    for library in libraries:
        library.chmod(0o666)
    backends._library.cache_clear()
    with pytest.warns(
        UserWarning,
        match=(
            r"the cached library .*\.so is not trusted \(others may write into .*\.so\) and is"
            r" built"
        ),
    ):
        evaluate(sweeps.scene(), backend=backend, flags="-O0")
    assert libraries
    assert not any(
        library.stat().st_mode & 0o22
        for library in libraries
        if library.name in os.listdir(fresh_cache)
    )


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
