"""Fixtures that several test modules share."""

from __future__ import annotations

import gc
import importlib
import json
import os
import shutil
import signal
import sys
import zlib
from contextlib import suppress
from pathlib import Path

import pytest
from hypothesis import settings

# The processes of the tests have the cores already: threads of NumPy's linear algebra beside them
# would mostly wait for each other. NumPy reads it when it is imported, so this comes before.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
# The tests' own cache would have each process make matplotlib's list of fonts anew.
os.environ.setdefault("MPLCONFIGDIR", str(Path.home() / ".cache" / "matplotlib"))

from internals import backends, compiler, cycle_table, grids

from lagrange_casadi import evaluate, load_case

# No test is about time. Where a failure must be the change's own, the same examples every time;
# elsewhere new ones.
settings.register_profile("usual", deadline=None, max_examples=40)
settings.register_profile("ci", settings.get_profile("usual"), derandomize=True, print_blob=True)
settings.load_profile("ci" if os.environ.get("CI") else "usual")

ROOT = Path(__file__).parent.parent
CASES = ROOT / "cases"
NAMES = sorted(path.parent.name for path in CASES.glob("*/case.py"))
SPATIAL = [name for name in NAMES if "SpatialMechanism(" in (CASES / name / "case.py").read_text()]
PLANAR = [name for name in NAMES if name not in SPATIAL]
# Of those in space the ones with few outputs: for what takes long of each output.
SMALL = ["cardan_shaft", "rssr", "spatial_slider_crank"]

# Vector Newton-Euler on free bodies in 60-digit arithmetic, the paper's mechanism and motion; its
# "about" says what each entry is.
SIXTY_DIGITS = json.loads(
    (ROOT / "tests" / "oracles" / "data" / "slider_crank_60_digits.json").read_text()
)

# Expressions are many small objects that live long: to look for circles among them often takes a
# twentieth of the time.
gc.set_threshold(20_000, 50, 100)

# For the benchmarks, which are not installed; last, so that the package is the installed one.
sys.path.append(str(ROOT))


@pytest.fixture(scope="session", autouse=True)
def _cache(pytestconfig, tmp_path_factory):
    """Compile into a cache of this session's own, which its processes share."""
    base = tmp_path_factory.getbasetemp()
    shared = base.parent if "PYTEST_XDIST_WORKER" in os.environ else base
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(shared / "cache"))
        kept = bytecode(pytestconfig)
        if kept is None:
            yield
            return
        # Each program that is started would read all modules anew, in half a second.
        patch.delenv("PYTHONDONTWRITEBYTECODE", raising=False)
        patch.setenv("PYTHONPYCACHEPREFIX", str(kept))
        yield
        # No other run will have the modules that tests wrote.
        shutil.rmtree(kept.joinpath(*shared.parts[1:]), ignore_errors=True)


@pytest.fixture(scope="session", autouse=True)
def _quick_to_build():
    """Build here without optimization, in a third of the time: test_codegen shows that not a bit
    depends on it.

    Programs that tests start, and modules that use ``released``, build as users do.
    """
    released = dict(compiler.FLAGS)
    with pytest.MonkeyPatch.context() as patch:
        for language, flags in released.items():
            patch.setitem(
                compiler.FLAGS, language, tuple("-O0" if flag == "-O3" else flag for flag in flags)
            )
        yield released


@pytest.fixture(scope="session", autouse=True)
def _no_wait_for_the_disk():
    """Leave files to the system, which writes them when it likes: thousands of them would each wait
    for the disk, and only a loss of power shows a difference.
    """
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(os, "fsync", lambda _: None)
        yield


@pytest.fixture(scope="module")
def released(_quick_to_build):
    """Build with the flags that users have, and forget what was built with
    others, or is built now.
    """
    loaded = (backends._library, grids._compiled, cycle_table._compiled)
    with pytest.MonkeyPatch.context() as patch:
        for language, flags in _quick_to_build.items():
            patch.setitem(compiler.FLAGS, language, flags)
        for kept in loaded:
            kept.cache_clear()
        yield
    for kept in loaded:
        kept.cache_clear()


@pytest.fixture(scope="module")
def interpreted():
    """Let CasADi's virtual machine evaluate doubles where no backend is asked for: for what is not
    about compiled code.

    Compiled code has the same numbers: test_codegen, test_lanes and test_every_way show that.
    """
    evaluator = backends.evaluator

    def asked(program, stages, method):
        if method.backend != "auto" or method.precision == "single":
            return evaluator(program, stages, method)
        interpreter = backends.Interpreter(program, stages, method.newton)
        return interpreter, backends.provenance(method, None)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(backends, "evaluator", asked)
        yield


@pytest.fixture(scope="session", autouse=True)
def _signals():
    """What started the tests may ignore some, as ``nohup`` does; programs that they start would
    too.
    """
    usual = {
        "SIGINT": signal.default_int_handler,
        "SIGTERM": signal.SIG_DFL,
        "SIGHUP": signal.SIG_DFL,
    }
    there = {
        getattr(signal, name): handler for name, handler in usual.items() if hasattr(signal, name)
    }
    before = {number: signal.signal(number, handler) for number, handler in there.items()}
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


@pytest.fixture
def fresh_cache(tmp_path, monkeypatch):
    """An empty cache, and where it is."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    return tmp_path / "cache" / "lagrange_casadi"


@pytest.fixture(scope="session")
def slider_crank():
    """The paper's case."""
    return load_case(CASES / "slider_crank")


@pytest.fixture(scope="session")
def solution(slider_crank):
    """The paper's case, evaluated as it stands."""
    return evaluate(slider_crank.scene)


def pytest_addoption(parser):
    parser.addoption("--update", action="store_true", help="write the golden texts anew")
    parser.addoption(
        "--long",
        action="store_true",
        help="also tests marked long, and all parameters of those marked sampled",
    )


def pytest_xdist_auto_num_workers():
    """One process more than there are processors: many tests wait, for what they have stopped or
    for what does not answer.
    """
    return (os.cpu_count() or 1) + 1


def pytest_configure(config):
    """Draw more examples where all that takes long is asked for."""
    if config.getoption("--long"):
        settings.register_profile("long", settings.default, max_examples=200)
        settings.load_profile("long")


def bytecode(config):
    """Where bytecode is kept if none may be written beside modules: with what else pytest keeps of
    earlier runs. Else None.
    """
    return (
        config.cache.mkdir("bytecode")
        if sys.dont_write_bytecode and hasattr(config, "cache")
        else None
    )


@pytest.hookimpl(hookwrapper=True)
def pytest_collection(session):
    """Read test modules as an earlier run compiled them, in half the time; what is there now stays
    to the end.
    """
    before, kept = (sys.dont_write_bytecode, sys.pycache_prefix), bytecode(session.config)
    if kept is not None:
        sys.dont_write_bytecode, sys.pycache_prefix = False, str(kept)
    asked = session.config.option.markexpr or session.config.args
    if asked == session.config.getini("testpaths"):
        import_share()
    yield
    sys.dont_write_bytecode, sys.pycache_prefix = before
    gc.freeze()  # no need to look for circles in it again and again


def import_share():
    """Import every so many of all test modules, each process others, so that none is compiled by
    all. What fails is reported where it is collected.
    """
    process = os.environ.get("PYTEST_XDIST_WORKER", "gw0").removeprefix("gw")
    count = int(os.environ.get("PYTEST_XDIST_WORKER_COUNT", "1"))
    for path in sorted(Path(__file__).parent.rglob("test_*.py"))[int(process) :: count]:
        with suppress(Exception, pytest.skip.Exception):
            importlib.import_module(path.stem)


def pytest_ignore_collect(collection_path, config):
    """Read no module without a quick test where these alone are asked for; of others nothing is
    said.
    """
    if config.option.markexpr == "quick" and collection_path.name.startswith("test_"):
        return "mark.quick" not in collection_path.read_text() or None
    return None


def is_whole(config):
    """Whether all that takes long, and all parameters, are asked for, or tests by name."""
    return config.getoption("--long") or any("::" in argument for argument in config.args)


@pytest.hookimpl(hookwrapper=True)
def pytest_generate_tests(metafunc):
    """Make no parameters that take long, and one in so many of a test that is sampled."""
    yield
    if is_whole(metafunc.config):
        return
    name, sampled = metafunc.definition.nodeid, metafunc.definition.get_closest_marker("sampled")
    # Which one it begins with is another for every test, so that all cases are among them; of each
    # test there is one at least.
    step = min(sampled.args[0], max(len(metafunc._calls), 1)) if sampled else 1
    metafunc._calls = [
        call
        for seen, call in enumerate(metafunc._calls, zlib.crc32(name.encode()))
        if seen % step == 0 and "long" not in [mark.name for mark in call.marks]
    ]


def pytest_collection_modifyitems(config, items):
    """Leave out long tests, unless they are asked for. What is early begins the order."""
    items.sort(key=lambda item: item.get_closest_marker("early") is None)
    left = [] if is_whole(config) else [item for item in items if item.get_closest_marker("long")]
    if left:
        config.hook.pytest_deselected(items=left)
        items[:] = [item for item in items if item not in left]


@pytest.fixture
def here(tmp_path, monkeypatch):
    """An empty folder that is the working directory."""
    monkeypatch.chdir(tmp_path)
    return tmp_path
