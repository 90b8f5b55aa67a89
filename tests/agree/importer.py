"""A tool that imports FMUs, as far as tests need one, and scenes to be imported."""

import math

import casadi as ca
import numpy as np
import pytest
from mechanisms import crank_and_rod

from lagrange_casadi import Mechanism, Scene
from lagrange_casadi.motion import harmonic

fmpy = pytest.importorskip("fmpy", reason="FMPy, of the extra 'fmu', is not installed")


def windy():
    """A slider-crank whose load depends on the time and on a parameter."""

    def loads(m, parts):
        gust = m.parameter("gust", 4.0, "N", low=0.0, high=100.0)
        m.force("wind", parts["b"].at(0.2, 0.01), x=gust * ca.sin(7 * m.time), y=-2.0)

    scene = crank_and_rod({"mass": 0.5}, loads=loads)
    return Scene(
        scene.mechanism, dict(scene.motion), ["all"], posture={"b": 0.0}, t=(0.3, 1.3, 101)
    )


def robot():
    """Three legs under a platform, whose loops are iterated; the length of a shin and the
    platform's mass are parameters.
    """
    m = Mechanism("robot")
    shin = m.parameter("shin", 0.28, "m", low=0.1, high=0.5)
    platform = m.link(
        "platform",
        length=0.2,
        mass=m.parameter("mass", 1.5, "kg", low=0.0),
        centre=(0.0, 0.0),
        inertia=0.01,
    )
    posture, motion = {"platform": 0.0}, {}
    for i in range(3):
        angle = 2 * math.pi * i / 3 + math.pi / 6
        upper = m.link(f"upper{i}", length=0.28, mass=0.8)
        lower = m.link(f"lower{i}", length=0.28 if i else shin, mass=0.5)
        m.revolute(f"drive{i}", m.ground.at(0.5 * math.cos(angle), 0.5 * math.sin(angle)), upper)
        m.revolute(f"knee{i}", upper.tip, lower)
        m.revolute(
            f"foot{i}", lower.tip, platform.at(0.12 * math.cos(angle), 0.12 * math.sin(angle))
        )
        inward = angle + math.pi
        posture[f"upper{i}"], posture[f"lower{i}"] = inward - 0.8, inward + 0.8
        motion[f"drive{i}"] = harmonic(inward - 0.8, 0.2, 1.0, 2 * math.pi * i / 3)
    return Scene(m, motion, ["all"], t=(0, 1, 201), posture=posture)


def signals(solution, ahead=0, **tuned):
    """The motion of the drives as FMPy takes it; ``ahead`` so many instants early."""
    names = [name for name in solution.series if name.startswith("motion:")]
    columns = {"time": solution.t} | {
        name.replace(":", "/"): np.append(
            solution.series[name][ahead:], [solution.series[name][-1]] * ahead
        )
        for name in names
    }
    columns |= tuned
    table = np.empty(solution.t.size, [(name, float) for name in columns])
    for name, values in columns.items():
        table[name] = values
    return table


def simulated(path, solution, kind="ModelExchange", ahead=0, start=None, **tuned):
    """The outputs at every instant of a solution."""
    step = float(solution.t[1] - solution.t[0])
    found = fmpy.simulate_fmu(
        str(path),
        fmi_type=kind,
        start_time=float(solution.t[0]),
        stop_time=float(solution.t[-1]),
        output_interval=step,
        input=signals(solution, ahead, **tuned),
        start_values=start or {},
        record_events=False,
    )
    # Older versions may take a step too many.
    return found[: solution.t.size]


class Instance:
    """An instance driven call by call, its variables by name; ``log`` is what it said."""

    def __init__(self, path, folder, kind="ModelExchange"):
        self.log = []
        self.description = fmpy.read_model_description(str(path))
        self.of = {v.name: v.valueReference for v in self.description.modelVariables}
        folder.mkdir(exist_ok=True)
        fmpy.extract(str(path), str(folder))
        self.fmu = fmpy.instantiate_fmu(str(folder), self.description, kind, logger=self._hear)

    def _hear(self, _environment, name, status, category, message):
        self.log.append((status, category.decode(), message.decode()))

    def begin(self, t=0.0, **values):
        self.fmu.setupExperiment(startTime=t)
        self.fmu.enterInitializationMode()
        self.set(**values)
        self.fmu.exitInitializationMode()
        return self

    def set(self, **values):
        self.fmu.setReal(
            [self.of[name.replace("__", "/")] for name in values], list(values.values())
        )

    def get(self, *names):
        return self.fmu.getReal([self.of[name] for name in names])


def refusing(status, call, *arguments, **values):
    with pytest.raises(fmpy.fmi1.FMICallException) as caught:
        call(*arguments, **values)
    assert caught.value.status == status
