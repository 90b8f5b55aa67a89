"""Sensitivities in exported C: what it gives, for which parameters, its self-test, and what it
costs where they are not wanted.
"""

import subprocess

import numpy as np
import pytest
from compiled import cc
from mechanisms import slider_crank, truss_platform

from lagrange_casadi import Mechanism, Scene, evaluate, export
from lagrange_casadi.motion import polynomial

WANTED = ["effort", "section:rod", "sensitivity:l", "sensitivity:m3"]
PROGRAM = """#include <stdio.h>
#include "@.h"
int main(void) {
  @_model model;
  @_inputs inputs;
  @_outputs outputs;
  @_sensitivities slopes;
  @_parameters parameters = @_defaults;
  int k;
  SET
  if (@_prepare(&model, &parameters) != @_OK) return 1;
  for (k = 0; k < COUNT; ++k) {
    const double t = START + k*(STOP - START)/(COUNT - 1);
    if (@_motion(&model, t, &inputs) != @_OK) return 2;
    if (@_sensitivity(&model, t, &inputs, &outputs, &slopes) != @_OK) return 3;
    printf(FORMAT, VALUES);
  }
  return 0;
}
"""


def printed(scene, folder, parameters, by, span):
    """The outputs and their derivatives that exported C gives over instants, (t, outputs, 1 +
    parameters).
    """
    made = export(scene, folder, wanted=[*scene.wanted, *(f"sensitivity:{name}" for name in by)])
    values = [
        f"outputs.{m.name}" if name is None else f"slopes.{m.name}.{name}"
        for m in made.outputs
        for name in (None, *by)
    ]
    start, stop, count = span
    words = {
        "SET": " ".join(f"parameters.{name} = {value!r};" for name, value in parameters.items()),
        "COUNT": str(count),
        "START": repr(float(start)),
        "STOP": repr(float(stop)),
        "FORMAT": '"' + "%.17g " * len(values) + '\\n"',
        "VALUES": ", ".join(values),
        "@_OK": f"{made.prefix.upper()}_OK",
        "@": made.prefix,
    }
    text = PROGRAM
    for word, value in words.items():
        text = text.replace(word, value)
    (folder / "main.c").write_text(text)
    result = cc(["cc", "-std=c99", "-Wall", "-Werror"], folder, f"{made.prefix}.c", "main.c")
    assert result.returncode == 0, result.stderr
    lines = subprocess.run(
        [folder / "program"], capture_output=True, text=True, check=True
    ).stdout.splitlines()
    found = np.array([[float(word) for word in line.split()] for line in lines])
    return made, found.reshape(count, len(made.outputs), 1 + len(by))


def rotor():
    """The motion is of parameters itself, and a load of the time."""
    m = Mechanism("rotor")
    speed = m.parameter("speed", 20.0, "rad/s")
    arm = m.link("arm", length=m.parameter("l", 0.4, "m"), mass=2.0)
    m.revolute("O", m.ground, arm)
    m.torque("late", arm, 3.0 * m.time**2 * speed)
    return Scene(m, {"O": polynomial(0.2, speed, speed / 3)}, t=(0, 0.2, 9))


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    ("make", "parameters", "by"),
    [
        (
            lambda: slider_crank(["effort", "reaction", "section:rod"]),
            {"l": 0.27, "m2": 0.3},
            ["r", "m2"],
        ),
        (rotor, {"speed": 31.0}, ["speed", "l"]),
        (truss_platform, {"shaft": 0.053}, ["shaft"]),
    ],
)
def test_it_gives_what_an_evaluation_gives(make, parameters, by, tmp_path):
    scene = make()
    span = (*scene.t[:2], 21)
    made, found = printed(scene, tmp_path, parameters, by, span)
    names = [*scene.wanted, *(f"sensitivity:{name}" for name in by)]
    solution = evaluate(
        scene, parameters=parameters, t=span, wanted=names, backend="vm", certificate=False
    )
    compared = 0
    for k, member in enumerate(made.outputs):
        if member.source not in solution.sensitivities.quantities:
            continue
        compared += 1
        for j, name in enumerate(by):
            exact = solution.sensitivities.array(member.source, name)
            size = (
                np.abs(exact).max()
                + np.abs(solution.array(member.source)).max()
                / solution.description["parameters"][name]["value"]
            )
            np.testing.assert_allclose(
                found[:, k, 1 + j],
                exact,
                rtol=0,
                atol=1e-11 * size + 1e-13,
                err_msg=f"{member.name} {name}",
            )
    assert compared >= 3
    assert np.abs(found[:, :, 1:]).max() > 0.0
