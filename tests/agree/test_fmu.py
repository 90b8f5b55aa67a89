"""The exported FMU, imported by FMPy: the numbers of the API, told in the words of the results
file, loud where it fails, and built of sources that compile elsewhere.
"""

import csv
import math
import shutil
import subprocess
import sys
import zipfile
from xml.etree import ElementTree

import numpy as np
import pytest
from compiled import fake_compiler, present
from conftest import CASES, SPATIAL
from importer import Instance, refusing, signals, simulated, windy
from machines import called_as_rates, elsewhere
from mechanisms import sampled_cam, slider_crank, truss_platform

from lagrange_casadi import errors, evaluate, export, load_case
from lagrange_casadi.cli import main

fmpy = pytest.importorskip("fmpy", reason="FMPy, of the extra 'fmu', is not installed")
fmi2 = pytest.importorskip("fmpy.fmi2")
validate_fmu = pytest.importorskip("fmpy.validation").validate_fmu
pytestmark = pytest.mark.skipif(not present("cc"), reason="there is no C compiler")

WITHIN = 1e-12
PEDANTIC = ["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-Wconversion", "-fPIC"]
SCENES = {
    "truss_platform": truss_platform,
    "windy": windy,
    "free": slider_crank,
    "cam": sampled_cam,
    "planetary": elsewhere,
    "rates": called_as_rates,
} | {
    name: lambda name=name: load_case(name).scene
    for name in ("slider_crank", "rrr3", "arm", *SPATIAL)
}
CHANGES = {
    "slider_crank": {"r": 0.08, "m3": 0.4},
    "truss_platform": {"shaft": 0.053},
    "windy": {"gust": 9.0},
}


@pytest.fixture(scope="session")
def unit(tmp_path_factory):
    """The FMU of a scene, by its name and how it is exported; made once."""
    made = {}

    def make(name, **how):
        key = (name, *sorted(how.items()))
        if key not in made:
            folder = tmp_path_factory.mktemp(name) / "out"
            scene = SCENES[name]()
            prefix = export(scene, folder, name=name, **{"fmu": True, **how}).prefix
            made[key] = (scene, folder / f"{prefix}.fmu")
        return made[key]

    return make


@pytest.fixture
def instances(tmp_path):
    made = []

    def make(path, kind="ModelExchange"):
        made.append(Instance(path, tmp_path / f"unit{len(made)}", kind))
        return made[-1]

    yield make
    for instance in made:
        instance.fmu.freeInstance()


def variables(path, causality):
    described = fmpy.read_model_description(str(path))
    return [v.name for v in described.modelVariables if v.causality == causality]


def assert_alike(found, solution, names, rows=slice(None)):
    """What is zero may be rounding."""
    assert names
    for name in names:
        own = name.replace("/", ":")
        expected = solution.series[own]
        assert found[name].shape == expected.shape
        gap = np.abs(found[name] - expected)[rows].max()
        allowed = WITHIN * np.abs(expected).max() + 30 * solution.errors.get(own, 0.0)
        assert gap <= allowed, f"{name}: {gap:.3g} of {np.abs(expected).max():.3g}"


@pytest.mark.sampled(13)
@pytest.mark.parametrize("kind", ["ModelExchange", "CoSimulation"])
@pytest.mark.parametrize("name", SCENES)
def test_it_is_valid_and_gives_the_numbers_of_the_api(unit, name, kind):
    """With the defaults and with other parameters. What FMPy reads after a step is of the inputs
    that it set before: they are given one step early.
    """
    scene, path = unit(name)
    assert validate_fmu(str(path)) == []
    ahead = int(kind == "CoSimulation")
    for changes in [{}, *([CHANGES[name]] if name in CHANGES else [])]:
        solution = evaluate(scene, parameters=changes)
        found = simulated(path, solution, kind, ahead=ahead, start=changes)
        assert_alike(found, solution, variables(path, "output"), slice(ahead, None))


@pytest.mark.parametrize("name", CHANGES)
def test_parameters_change_during_a_run(unit, name):
    """Loops and angles go on from where they are."""
    scene, path = unit(name)
    before, after = evaluate(scene), evaluate(scene, parameters=CHANGES[name])
    late = np.arange(before.t.size) >= before.t.size // 2
    defaults = scene.mechanism.values()
    tuned = {key: np.where(late, value, defaults[key]) for key, value in CHANGES[name].items()}
    found = simulated(path, before, **tuned)
    for solution, rows in ((before, ~late), (after, late)):
        assert_alike(found, solution, variables(path, "output"), rows)


def test_single_precision_keeps_phases(unit):
    """After 10^5 turns a single holds an angle to 0.06 rad: the rest comes from the importer's
    double.
    """
    scene, path = unit("slider_crank", precision="single")
    solution = evaluate(scene)
    turned = signals(solution)
    turned["motion/O"] += math.tau * 1e5
    span = {"stop_time": 0.08, "output_interval": float(solution.t[1] - solution.t[0])}
    found = fmpy.simulate_fmu(str(path), fmi_type="ModelExchange", input=turned, **span)
    for name in ("effort/O", "reaction/guide/fy", "motion/guide"):
        expected = solution.series[name.replace("/", ":")]
        assert np.abs(found[name] - expected).max() < 2e-5 * np.abs(expected).max(), name


def test_the_motion_is_inside_by_the_angle_of_a_crank(unit, tmp_path):
    """Rates and accelerations follow from the angle alone, of turns before and after the scene's
    too; a coordinate that turns back says no time.
    """
    scene, path = unit("slider_crank", fmu="O")
    assert variables(path, "input") == ["motion/O"]
    names = [n for n in variables(path, "output") if n.startswith(("effort", "reaction"))]
    for span in ((0.0, 0.08), (-0.3, -0.1), (1.0, 1.1)):
        solution = evaluate(scene, wanted=["all"], t=(*span, 41))
        table = np.zeros(solution.t.size, [("time", float), ("motion/O", float)])
        table["time"], table["motion/O"] = np.arange(41.0), solution.series["motion:O"]
        steps = {"start_time": 0.0, "stop_time": 40.0, "output_interval": 1.0}
        found = fmpy.simulate_fmu(
            str(path), **steps, input=table, fmi_type="ModelExchange", output=names
        )
        assert_alike(found, solution, names)
    for by, says in (("turn", "this coordinate stops or"), ("twist", "unknown coordinate 'twist'")):
        with pytest.raises(errors.LagrangeCasadiError, match=says):
            export(load_case("arm6").scene, tmp_path / "a", fmu=by, wanted=["effort"])


@pytest.mark.parametrize(
    ("name", "by"),
    [("truss_platform", True), ("windy", "time"), ("slider_crank", "O"), ("rates", "pin_rate")],
)
def test_a_script_compares_a_unit_with_its_golden_vectors(unit, name, by, tmp_path):
    """The first iterates its loops; each number that is changed is noticed."""
    path = unit(name, fmu=by)[1]
    assert by != "time" or variables(path, "input") == []
    script = f"{path.stem}_fmu_test.py"
    shutil.copy(path.with_name(script), tmp_path)
    with zipfile.ZipFile(path) as there, zipfile.ZipFile(tmp_path / path.name, "w") as wrong:
        for file in there.namelist():
            data = there.read(file)
            if file == "resources/golden.csv":
                rows = list(csv.reader(data.decode().splitlines()))
                rows[2][-1] = str(float(rows[2][-1]) + 2 * float(rows[1][-1]) + 1e-300)
                data = "\n".join(map(",".join, rows)).encode()
            wrong.writestr(file, data)
    for folder, count in ((path.parent, 0), (tmp_path, 1)):
        done = subprocess.run([sys.executable, script], cwd=folder, capture_output=True, text=True)
        assert done.stdout.splitlines()[-1] == f"{path.name}: {count} failures", done.stderr
        assert done.returncode == count


def test_a_bad_parameter_is_an_error_that_names_it(unit, instances):
    """That is out of its range, or makes a part impossible; the value before stays."""
    it = instances(unit("slider_crank")[1]).begin()
    (effort,) = it.get("effort/O")
    for value in (-0.1, math.nan, math.inf):
        refusing(fmi2.fmi2Error, it.set, r=value)
        status, category, message = it.log.pop()
        assert (status, category) == (fmi2.fmi2Error, "logStatusError")
        assert message.startswith(f"r = {value:.9g}: a parameter is not finite, or out of its")
    assert it.get("effort/O", "r") == [effort, 0.1]


def test_an_instant_without_a_result_is_discarded_and_says_why(unit, instances):
    it = instances(unit("slider_crank")[1]).begin(l=0.05)
    (effort,) = it.get("effort/O")
    for angle, says in (
        (1.5, "a loop cannot be closed: its links do not reach"),
        (math.nan, "an input is not finite"),
    ):
        it.set(motion__O=angle)
        refusing(fmi2.fmi2Discard, it.get, "effort/O")
        assert it.log.pop() == (fmi2.fmi2Discard, "logStatusDiscard", f"t = 0 s: {says}")
    it.set(motion__O=0.0)
    assert it.get("effort/O") == [effort]


def test_a_state_is_kept_and_taken_back(unit, instances):
    """Whole turns and loops included; another instance knows nothing of it."""
    path = unit("slider_crank")[1]
    it, other = instances(path).begin(), instances(path).begin()
    for angle in np.arange(0.0, 20.0, 0.5):
        it.set(motion__O=float(angle))
        kept = it.get("motion/A", "effort/O", "r")
    assert kept[0] < -math.tau
    state = it.fmu.getFMUstate()
    for angle in np.arange(20.0, 0.0, -0.5):
        it.set(motion__O=float(angle), r=0.09)
        it.get("motion/A")
    it.fmu.setFMUstate(state)
    assert it.get("motion/A", "effort/O", "r") == kept
    assert other.get("motion/A", "r") == [0.0, 0.1]


def test_calls_out_of_order_and_what_is_not_there_are_errors(unit, instances):
    it = instances(unit("slider_crank")[1])
    refusing(fmi2.fmi2Error, it.fmu.exitInitializationMode)
    assert it.log.pop()[2] == "fmi2ExitInitializationMode is called out of order"
    it.begin()
    refusing(fmi2.fmi2Error, it.fmu.getReal, [len(it.of)])
    refusing(fmi2.fmi2Error, it.fmu.setReal, [it.of["effort/O"]], [1.0])
    it.fmu.terminate()
    refusing(fmi2.fmi2Error, it.set, motion__O=0.1)


@pytest.mark.parametrize("name", ["truss_platform", "windy"])
def test_nothing_depends_on_more_than_is_said(unit, instances, name):
    """And every dependency is felt by some instant, but for those that only the structure has."""
    it = instances(unit(name)[1]).begin(0.3)
    names = variables(unit(name)[1], "output")
    unknown = it.description.initialUnknowns
    said = {u.variable.name: {v.name for v in u.dependencies} for u in unknown}
    felt, before = {key: set() for key in names}, it.get(*names)
    for v in it.description.modelVariables:
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
    claimed = sum(len(said[key] - {"time"}) for key in names)
    assert claimed <= 1.25 * sum(map(len, felt.values()))


def test_names_units_and_limits(unit):
    """As in a file of results, or as they were declared; no clock and no path."""
    scene, path = unit("windy")
    solution = evaluate(scene)
    with zipfile.ZipFile(path) as archive:
        root = ElementTree.fromstring(archive.read("modelDescription.xml"))
        for entry in archive.infolist():
            assert entry.date_time == (1980, 1, 1, 0, 0, 0)
            assert b"/tmp/" not in archive.read(entry)
    assert root.get("generationDateAndTime") is None
    told = {v.get("name"): v for v in root.iter("ScalarVariable")}
    assert {name.replace("/", ":") for name in told} == {*solution.series, "gust", "time"}
    for name, variable in told.items():
        if name not in ("gust", "time"):
            assert variable.find("Real").get("unit") == solution.unit(name.replace("/", ":"))
            given = "input" if name.startswith("motion/O") else "output"
            assert variable.get("causality") == given
    gust = {"unit": "N", "min": "0.0", "max": "100.0", "start": "4.0"}
    assert told["gust"].find("Real").attrib == gust
    units = {one.get("name"): one for one in root.iter("Unit")}
    assert units["N m"].find("BaseUnit").attrib == {"kg": "1", "m": "2", "s": "-2"}
    experiment = {"startTime": "0.3", "stopTime": "1.3", "stepSize": "0.01"}
    assert root.find("DefaultExperiment").attrib == experiment


@pytest.mark.sampled(5)
@pytest.mark.parametrize("compiler", ["gcc", "clang"])
@pytest.mark.parametrize(
    ("name", "how"),
    [("truss_platform", {}), ("windy", {"precision": "single"}), ("free", {"table": 1e-6})],
)
def test_the_sources_compile_elsewhere(unit, name, how, compiler, tmp_path):
    if not present(compiler):
        pytest.skip(f"{compiler} is not installed")
    with zipfile.ZipFile(unit(name, **how)[1]) as archive:
        archive.extractall(tmp_path)
    sources = tmp_path / "sources"
    root = ElementTree.parse(tmp_path / "modelDescription.xml")
    listed = {file.get("name") for file in root.iter("File")}
    assert listed == {path.name for path in sources.glob("*.c")}
    own = [f"-DFMI2_FUNCTION_PREFIX={name}_", "-c", f"{name}_fmi2.c", "-o", "unit.o"]
    for words in (["-shared", *sorted(listed), "-o", "unit.so", "-lm"], own):
        subprocess.run([compiler, *PEDANTIC, "-O1", *words], cwd=sources, check=True)
    assert f"{name}_fmi2GetReal".encode() in (sources / "unit.o").read_bytes()


def test_the_folder_knows_its_unit(tmp_path):
    """Which has the same bytes every time."""
    out, made = tmp_path / "out", []
    path = out / "slider_crank.fmu"
    for _ in range(2):
        export(slider_crank(), out, fmu=True)
        made.append(path.read_bytes())
    assert made[0] == made[1]
    export(slider_crank(), out)
    assert not path.exists(), "a unit of an earlier export would be taken for one of this"


BUILDS = (
    'test "$1" = --version && exit 0; while [ $# -gt 0 ]; do [ "$1" = -o ] && out=$2; shift; done; '
)


def test_a_binary_that_does_not_load_is_not_shipped(here, tmp_path_factory, monkeypatch):
    script = f"{BUILDS} echo nothing > $out"
    fake_compiler(tmp_path_factory.mktemp("fake"), monkeypatch, script)
    with pytest.raises(errors.CompilerError, match=r"built by .*fake-cc does not load: "):
        export(slider_crank(), here / "out", fmu=True, wanted=["effort"])
    assert not list(here.iterdir())


def test_what_is_missing_is_said_before_anything_is_written(tmp_path, monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "fmpy", None)
    with pytest.raises(errors.LagrangeCasadiError, match="needs FMPy; install it with"):
        export(slider_crank(), tmp_path / "out", fmu=True)
    assert main(["export", str(CASES / "arm"), "--out", str(tmp_path / "out"), "--fmu"]) == 2
    assert not list(tmp_path.iterdir())
