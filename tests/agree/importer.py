"""A tool that imports FMUs, as far as tests need one, and scenes to be imported."""

import casadi as ca
import numpy as np
import pytest
from mechanisms import crank_and_rod

from lagrange_casadi import Scene

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
