"""What is in the exported FMU: the description, sources that compile elsewhere, and the same bytes
every time.
"""

import shutil
import subprocess
import sys
import zipfile
from xml.etree import ElementTree

import pytest
from compiled import fake_compiler
from conftest import CASES
from importer import Instance, robot, windy
from internals import export, find_compiler, fmu
from mechanisms import slider_crank

from lagrange_casadi import evaluate
from lagrange_casadi.cli import main
from lagrange_casadi.errors import CompilerError, LagrangeCasadiError, PathError, StoreError

fmpy = pytest.importorskip("fmpy", reason="FMPy, of the extra 'fmu', is not installed")
pytestmark = pytest.mark.skipif(
    find_compiler() is None, reason="there is no C compiler to build an FMU with"
)

PEDANTIC = ["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-Wconversion"]


@pytest.fixture(scope="module")
def archives(tmp_path_factory):
    """FMUs by name."""
    folder = tmp_path_factory.mktemp("units")
    scenes = {"slider_crank": slider_crank(), "robot": robot(), "windy": windy()}
    for name, scene in scenes.items():
        export(scene, folder / name, name=name, fmu=True)
    export(scenes["windy"], folder / "single", name="single", fmu=True, precision="single")
    export(scenes["slider_crank"], folder / "table", name="table", fmu=True, table=1e-6)
    return {path.stem: path for path in folder.glob("*/*.fmu")}


def described(path):
    with zipfile.ZipFile(path) as archive:
        return ElementTree.fromstring(archive.read("modelDescription.xml"))


def test_the_same_bytes_every_time(tmp_path):
    made = []
    for place in ("here", "there"):
        (tmp_path / place).mkdir()
        export(slider_crank(), tmp_path / place / "out", fmu=True)
        made.append((tmp_path / place / "out" / "slider_crank.fmu").read_bytes())
    assert made[0] == made[1]


def test_no_clock_and_no_path(archives):
    for path in archives.values():
        assert described(path).get("generationDateAndTime") is None
        with zipfile.ZipFile(path) as archive:
            assert [entry.filename for entry in archive.infolist()] == sorted(archive.namelist())
            for entry in archive.infolist():
                assert entry.date_time == (1980, 1, 1, 0, 0, 0)
                assert b"/tmp/" not in archive.read(entry)
                assert b"lagrange_casadi-" not in archive.read(entry)


@pytest.mark.sampled(7)
@pytest.mark.parametrize("compiler", ["gcc", "clang"])
@pytest.mark.parametrize("name", ["slider_crank", "robot", "windy", "single", "table"])
def test_the_sources_compile_elsewhere(archives, name, compiler, tmp_path):
    if shutil.which(compiler) is None:
        pytest.skip(f"{compiler} is not installed")
    with zipfile.ZipFile(archives[name]) as archive:
        archive.extractall(tmp_path)
    listed = {file.get("name") for file in described(archives[name]).iter("File")}
    sources = tmp_path / "sources"
    assert listed == {path.name for path in sources.glob("*.c")}
    command = [
        compiler,
        *PEDANTIC,
        "-O1",
        "-fPIC",
        "-shared",
        *sorted(listed),
        "-o",
        "unit.so",
        "-lm",
    ]
    subprocess.run(command, cwd=sources, check=True)
    prefixed = [
        compiler,
        *PEDANTIC,
        f"-DFMI2_FUNCTION_PREFIX={name}_",
        "-c",
        f"{name}_fmi2.c",
        "-o",
        "unit.o",
    ]
    subprocess.run(prefixed, cwd=sources, check=True)
    assert f"{name}_fmi2GetReal".encode() in (sources / "unit.o").read_bytes()
    assert (
        "Redistribution and use in source and binary forms"
        in (sources / "fmi2Functions.h").read_text()
    )


def test_names_units_and_limits(archives):
    """As in a file of results, or as they were declared."""
    solution = evaluate(windy())
    root = described(archives["windy"])
    variables = {v.get("name"): v for v in root.iter("ScalarVariable")}
    assert {name.replace("/", ":") for name in variables} == {*solution.series, "gust", "time"}
    for name, variable in variables.items():
        if name not in ("gust", "time"):
            assert variable.find("Real").get("unit") == solution.unit(name.replace("/", ":"))
            assert variable.get("causality") == (
                "input" if name.startswith("motion/O") else "output"
            )
    assert variables["gust"].find("Real").attrib == {
        "unit": "N",
        "min": "0.0",
        "max": "100.0",
        "start": "4.0",
    }
    starts = {
        name: float(variables[f"motion/{name}"].find("Real").get("start"))
        for name in ("O", "O_rate", "O_acceleration")
    }
    assert starts == pytest.approx(
        {name: solution.series[f"motion:{name}"][0] for name in starts}, rel=1e-15
    )
    units = {unit.get("name"): unit for unit in root.iter("Unit")}
    assert units["N m"].find("BaseUnit").attrib == {"kg": "1", "m": "2", "s": "-2"}
    assert root.get("variableNamingConvention") == "flat"
    assert root.find("DefaultExperiment").attrib == {
        "startTime": "0.3",
        "stopTime": "1.3",
        "stepSize": "0.01",
    }


@pytest.mark.parametrize("name", ["robot", "windy"])
def test_nothing_depends_on_more_than_is_said(archives, name, tmp_path):
    """And every dependency is felt by some instant, but for those that only the structure has."""
    it = Instance(archives[name], tmp_path / "unit").begin(0.3)
    variables = it.description.modelVariables
    names = [v.name for v in variables if v.causality == "output"]
    said = {
        u.variable.name: {v.name for v in u.dependencies} for u in it.description.initialUnknowns
    }
    directly = {u.variable.name: {v.name for v in u.dependencies} for u in it.description.outputs}
    felt = {key: set() for key in names}
    before = it.get(*names)
    for v in variables:
        if v.causality in ("parameter", "input"):
            (value,) = it.get(v.name)
            it.set(**{v.name: value + 1e-3})
            changed = it.get(*names)
            it.set(**{v.name: value})
            for key, old, new in zip(names, before, changed, strict=True):
                if abs(new - old) > 1e-9 * abs(old):
                    felt[key].add(v.name)
                if v.name not in said[key]:
                    assert new == pytest.approx(old, rel=1e-12, abs=1e-12), (key, v.name)
    it.fmu.freeInstance()
    parameters = {v.name for v in variables if v.causality == "parameter"}
    assert all(directly[key] == said[key] - parameters for key in names)
    assert sum(len(said[key] - {"time"}) for key in names) <= 1.25 * sum(
        len(felt[key]) for key in names
    )
    if name == "windy":
        assert "time" in directly["effort/O"]
        assert "time" not in directly["pose/b/x"]


def test_the_folder_knows_its_unit(tmp_path):
    scene, out = slider_crank(), tmp_path / "out"
    export(scene, out, fmu=True)
    export(scene, out, fmu=True)
    path = out / "slider_crank.fmu"
    path.write_bytes(path.read_bytes() + b" ")
    with pytest.raises(PathError, match=r"'slider_crank\.fmu' was changed since"):
        export(scene, out, fmu=True)
    export(scene, out, fmu=True, force=True)
    export(scene, out)
    assert not path.exists(), "a unit of an earlier export would be taken for one of this"
    path.write_bytes(b"mine")
    with pytest.raises(PathError, match="no file of an export"):
        export(scene, out, fmu=True, force=True)
    export(scene, out, force=True)
    assert path.read_bytes() == b"mine"


def test_what_is_missing_is_said_before_anything_is_written(tmp_path, monkeypatch, capsys):
    with monkeypatch.context() as patch:
        patch.setitem(sys.modules, "fmpy", None)
        with pytest.raises(LagrangeCasadiError, match="needs FMPy; install it with"):
            export(slider_crank(), tmp_path / "out", fmu=True)
        assert (
            main(["export", str(CASES / "slider_crank"), "--out", str(tmp_path / "out"), "--fmu"])
            == 2
        )
        assert capsys.readouterr().err.count("\n") == 1
    monkeypatch.setattr(fmu, "find_compiler", lambda: None)
    with pytest.raises(CompilerError, match="needs a C compiler"):
        export(slider_crank(), tmp_path / "out", fmu=True)
    assert not (tmp_path / "out").exists()


def test_a_finding_of_fmpy_is_an_error(tmp_path, monkeypatch):
    monkeypatch.setattr("fmpy.validation.validate_fmu", lambda path: ["a unit\nis wrong"])
    with pytest.raises(StoreError, match=r"reports an error in slider_crank\.fmu: a unit is wrong"):
        export(slider_crank(), tmp_path / "out", fmu=True)
    assert not (tmp_path / "out").exists()


def test_a_compiler_that_refuses_is_quoted(tmp_path, monkeypatch):
    monkeypatch.setattr(fmu, "wrapper", lambda description: "#error nonsense\n")
    with pytest.raises(CompilerError, match="nonsense"):
        export(slider_crank(), tmp_path / "out", fmu=True)


BUILDS = (
    'test "$1" = --version && exit 0; while [ $# -gt 0 ]; do [ "$1" = -o ] && out=$2; shift; done; '
)
OTHERS = {
    "nothing that loads": "echo nothing > $out",
    "another library": "echo 'int x;' | {cc} -shared -fPIC -xc - -o $out",
    "another version": (
        "echo 'const char* fmi2GetVersion(void) {{ return \"3.0\"; }}' | {cc} -shared -fPIC -xc -"
        " -o $out"
    ),
}


@pytest.mark.parametrize("builds", OTHERS.values(), ids=OTHERS)
def test_a_binary_that_does_not_load_is_not_shipped(here, tmp_path_factory, monkeypatch, builds):
    fake_compiler(
        tmp_path_factory.mktemp("fake"), monkeypatch, BUILDS + builds.format(cc=shutil.which("cc"))
    )
    with pytest.raises(CompilerError, match=r"the library built by .*fake-cc does not load: "):
        export(slider_crank(), here / "out", fmu=True, wanted=["effort"])
    assert not list(here.iterdir())
