"""The exported FMU, imported by FMPy: the numbers of the API, told in the words of the results
file, and loud where it fails.
"""

import csv
import math
import shutil
import subprocess
import sys
import zipfile

import numpy as np
import pytest
from conftest import CASES, SPATIAL
from importer import Instance, refusing, robot, signals, simulated, windy
from internals import export, find_compiler
from machines import called_as_rates, elsewhere
from mechanisms import sampled_cam
from mechanisms import slider_crank as free

from lagrange_casadi import derive, evaluate, load_case

fmpy = pytest.importorskip("fmpy", reason="FMPy, of the extra 'fmu', is not installed")
fmi2 = pytest.importorskip("fmpy.fmi2")
validate_fmu = pytest.importorskip("fmpy.validation").validate_fmu
pytestmark = pytest.mark.skipif(
    find_compiler() is None, reason="there is no C compiler to build an FMU with"
)

WITHIN = 1e-12


SCENES = {
    "slider_crank": lambda: load_case(CASES / "slider_crank").scene,
    "rrr3": lambda: load_case(CASES / "rrr3").scene,
    "robot": robot,
    "arm": lambda: load_case(CASES / "arm").scene,
    "windy": windy,
    "free": free,
    "cam": sampled_cam,
    "planetary": elsewhere,
    "rates": called_as_rates,
}
GUIDED = {name: lambda name=name: load_case(CASES / name).scene for name in ("excavator", *SPATIAL)}


@pytest.fixture(scope="session")
def unit(tmp_path_factory):
    """The FMU of a scene, by its name and how it is exported; made once."""
    made = {}

    def make(name, **how):
        key = (name, *sorted(how.items()))
        if key not in made:
            folder = tmp_path_factory.mktemp(name) / "out"
            scene = (SCENES | GUIDED)[name]()
            made[key] = (
                scene,
                folder / f"{export(scene, folder, name=name, **{'fmu': True, **how}).prefix}.fmu",
            )
        return made[key]

    return make


def outputs(path):
    return [
        v.name
        for v in fmpy.read_model_description(str(path)).modelVariables
        if v.causality == "output"
    ]


def assert_alike(found, solution, names, rows=slice(None), within=WITHIN):
    assert names
    for name in names:
        expected = solution.series[name.replace("/", ":")]
        assert found[name].shape == expected.shape
        gap = np.abs(found[name] - expected)[rows].max()
        assert gap <= within * np.abs(expected).max(), (
            f"{name}: {gap:.3g} of {np.abs(expected).max():.3g}"
        )


@pytest.mark.sampled(5)
@pytest.mark.parametrize("name", SCENES)
def test_nothing_is_wrong_with_it(unit, name):
    assert validate_fmu(str(unit(name)[1])) == []


@pytest.mark.sampled(5)
@pytest.mark.parametrize("name", SCENES)
def test_model_exchange_gives_the_numbers_of_the_api(unit, name):
    scene, path = unit(name)
    solution = evaluate(scene)
    assert_alike(simulated(path, solution), solution, outputs(path))


@pytest.mark.sampled(9)
@pytest.mark.parametrize("name", SCENES)
def test_co_simulation_gives_the_numbers_of_the_api(unit, name):
    """What FMPy reads after a step is of the inputs that it set before: they are given one step
    early.
    """
    scene, path = unit(name)
    solution = evaluate(scene)
    assert_alike(
        simulated(path, solution, "CoSimulation", ahead=1), solution, outputs(path), slice(1, None)
    )


def test_the_motion_of_what_is_guided_is_an_input(unit):
    """The pose of an excavator's bucket: place, direction, and their rates and accelerations."""
    scene, path = unit("excavator")
    program, solution = derive(scene), evaluate(scene)
    orders = [program.motion(t, list(scene.mechanism.values().values())) for t in solution.t]
    poses = {
        f"motion/{name}{end}": np.array([float(order[k][i]) for order in orders])
        for i, name in enumerate(program.driven)
        for k, end in enumerate(("", "_rate", "_acceleration"))
    }
    assert "motion/bucket.angle_rate" in poses
    assert_alike(simulated(path, solution, **poses), solution, outputs(path))


CHANGES = {
    "slider_crank": {"r": 0.08, "m3": 0.4},
    "robot": {"shin": 0.29, "mass": 2.0},
    "windy": {"gust": 9.0},
}


@pytest.mark.parametrize("kind", ["ModelExchange", "CoSimulation"])
@pytest.mark.parametrize("name", CHANGES)
def test_parameters_change_between_runs(unit, name, kind):
    scene, path = unit(name)
    solution = evaluate(scene, parameters=CHANGES[name])
    late = kind == "CoSimulation"
    found = simulated(path, solution, kind, ahead=int(late), start=CHANGES[name])
    assert_alike(found, solution, outputs(path), slice(int(late), None))


@pytest.mark.parametrize("name", CHANGES)
def test_parameters_change_during_a_run(unit, name):
    """Loops and angles go on from where they are."""
    scene, path = unit(name)
    before, after = evaluate(scene), evaluate(scene, parameters=CHANGES[name])
    late = np.arange(before.t.size) >= before.t.size // 2
    defaults = {key: p["value"] for key, p in before.description["parameters"].items()}
    tuned = {key: np.where(late, value, defaults[key]) for key, value in CHANGES[name].items()}
    found = simulated(path, before, **tuned)
    for solution, rows in ((before, ~late), (after, late)):
        assert_alike(found, solution, outputs(path), rows)
    assert (
        np.abs(
            after.series["effort:" + drive(scene)] - before.series["effort:" + drive(scene)]
        ).max()
        > 0
    )


def drive(scene):
    return next(iter(scene.motion))


def test_single_precision_keeps_phases(unit):
    """After 10^5 turns a single holds an angle to 0.06 rad: the rest comes from the importer's
    double.
    """
    scene, path = unit("slider_crank", precision="single")
    solution = evaluate(scene)
    turned = signals(solution)
    turned["motion/O"] += math.tau * 1e5
    step = float(solution.t[1] - solution.t[0])
    found = fmpy.simulate_fmu(
        str(path), fmi_type="ModelExchange", stop_time=0.08, output_interval=step, input=turned
    )
    for name in ("effort/O", "reaction/guide/fy", "motion/guide"):
        expected = solution.series[name.replace("/", ":")]
        assert np.abs(found[name] - expected).max() < 2e-5 * np.abs(expected).max(), name


@pytest.fixture
def instances(tmp_path):
    made = []

    def make(path, kind="ModelExchange"):
        made.append(Instance(path, tmp_path / f"unit{len(made)}", kind))
        return made[-1]

    yield make
    for instance in made:
        instance.fmu.freeInstance()


def test_a_bad_parameter_is_an_error_that_names_it(unit, instances):
    it = instances(unit("slider_crank")[1]).begin()
    (effort,) = it.get("effort/O")
    for value in (-0.1, math.nan, math.inf):
        refusing(fmi2.fmi2Error, it.set, r=value)
        status, category, message = it.log.pop()
        assert (status, category) == (fmi2.fmi2Error, "logStatusError")
        assert message.startswith(
            f"r = {value:.9g}: a parameter is not finite, or out of its range"
        )
    assert it.get("effort/O", "r") == [effort, 0.1]
    assert not it.log


def test_parameters_that_make_a_part_impossible_are_an_error(unit, instances):
    """They have no limits of their own there."""
    it = instances(unit("free")[1]).begin()
    (effort,) = it.get("effort/O")
    it.set(m2=-0.1)
    for _ in range(2):
        refusing(fmi2.fmi2Error, it.get, "effort/O")
    assert [message for _, _, message in it.log] == [
        (
            "t = 0 s: a parameter is not finite, or out of its range, or gives a link no length"
            " or a negative mass"
        )
    ]
    it.set(m2=0.1)
    assert it.get("effort/O") == [effort]
    it.fmu.reset()
    refusing(fmi2.fmi2Error, it.begin, m2=-0.1)


def test_an_instant_without_a_result_is_discarded_and_says_why(unit, instances):
    it = instances(unit("slider_crank")[1]).begin(l=0.05)
    (effort,) = it.get("effort/O")
    it.set(motion__O=1.5)
    for _ in range(2):
        refusing(fmi2.fmi2Discard, it.get, "effort/O")
    assert it.log == [
        (
            fmi2.fmi2Discard,
            "logStatusDiscard",
            "t = 0 s: a loop cannot be closed: its links do not reach",
        )
    ]
    it.set(motion__O=math.nan)
    refusing(fmi2.fmi2Discard, it.get, "effort/O")
    assert it.log.pop()[2] == "t = 0 s: an input is not finite"
    it.set(motion__O=0.0)
    assert it.get("effort/O") == [effort]


def test_a_state_is_kept_and_taken_back(unit, instances):
    """Whole turns and loops included."""
    it = instances(unit("slider_crank")[1]).begin()
    for angle in np.arange(0.0, 20.0, 0.5):
        it.set(motion__O=float(angle))
        kept_values = it.get("motion/A", "effort/O", "r")
    assert kept_values[0] < -math.tau
    state = it.fmu.getFMUstate()
    for angle in np.arange(20.0, 0.0, -0.5):
        it.set(motion__O=float(angle), r=0.09)
        it.get("motion/A")
    it.fmu.setFMUstate(state)
    assert it.get("motion/A", "effort/O", "r") == kept_values
    it.fmu.freeFMUstate(state)
    it.fmu.reset()
    it.begin()
    assert it.get("motion/A", "r") == [0.0, 0.1]


def test_calls_out_of_order_and_what_is_not_there_are_errors(unit, instances):
    it = instances(unit("slider_crank")[1])
    refusing(fmi2.fmi2Error, it.fmu.newDiscreteStates)
    refusing(fmi2.fmi2Error, it.fmu.exitInitializationMode)
    it.begin()
    refusing(fmi2.fmi2Error, it.fmu.enterInitializationMode)
    assert [message for _, _, message in it.log] == [
        "fmi2NewDiscreteStates is called out of order",
        "fmi2ExitInitializationMode is called out of order",
        "fmi2EnterInitializationMode is called out of order",
    ]
    refusing(fmi2.fmi2Error, it.fmu.getReal, [len(it.of)])
    refusing(fmi2.fmi2Error, it.fmu.setReal, [it.of["effort/O"]], [1.0])
    refusing(fmi2.fmi2Error, it.fmu.getInteger, [0])
    refusing(fmi2.fmi2Error, it.fmu.setString, [0], [""])
    it.fmu.terminate()
    refusing(fmi2.fmi2Error, it.set, motion__O=0.1)


@pytest.mark.parametrize("name", ["slider_crank", "windy", "free"])
def test_the_motion_is_inside_by_time(unit, name):
    scene, path = unit(name, fmu="time")
    solution = evaluate(scene)
    described = fmpy.read_model_description(str(path))
    assert [v.name for v in described.modelVariables if v.causality == "input"] == []
    found = fmpy.simulate_fmu(
        str(path),
        start_time=solution.t[0],
        stop_time=solution.t[-1],
        output_interval=solution.t[1] - solution.t[0],
        fmi_type="ModelExchange",
        output=outputs(path),
    )
    assert found["time"].shape == solution.t.shape
    assert_alike(found, solution, outputs(path))


def test_the_motion_is_inside_by_the_angle_of_a_crank(unit, tmp_path):
    """Rates and accelerations follow from the angle alone, of turns before and after the scene's
    too.
    """
    scene, path = unit("slider_crank", fmu="O")
    described = fmpy.read_model_description(str(path))
    given = [v.name for v in described.modelVariables if v.causality == "input"]
    assert given == ["motion/O"]
    names = [name for name in outputs(path) if name.startswith(("effort", "reaction"))]
    for span in ((0.0, 0.08), (-0.3, -0.1), (1.0, 1.1)):
        solution = evaluate(scene, wanted=["all"], t=(*span, 41))
        table = np.zeros(solution.t.size, [("time", float), ("motion/O", float)])
        table["time"], table["motion/O"] = np.arange(41.0), solution.series["motion:O"]
        steps = {"start_time": 0.0, "stop_time": 40.0, "output_interval": 1.0}
        found = fmpy.simulate_fmu(
            str(path), **steps, input=table, fmi_type="ModelExchange", output=names
        )
        assert_alike(found, solution, names)


@pytest.mark.parametrize(
    ("name", "by"),
    [("robot", True), ("windy", "time"), ("slider_crank", "O"), ("rates", "pin_rate")],
)
def test_a_script_compares_a_unit_with_its_golden_vectors(unit, name, by, tmp_path):
    """The first iterates its loops; each number that is changed is noticed."""
    path = unit(name, fmu=by)[1]
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
