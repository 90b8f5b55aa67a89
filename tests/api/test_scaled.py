"""Samples that parameters scale and shift: a gear's ratio, a cycle's duration."""

import casadi as ca
import numpy as np
import pytest
from internals import DesignEngine, Laws, Scaled, Status

from lagrange_casadi import Mechanism, Scene, evaluate, motion, refine
from lagrange_casadi.errors import DeclarationError

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]

TIMES = np.linspace(0.0, 1.0, 14)
ANGLES = 0.4 * np.sin(5 * TIMES) + TIMES**2


def geared(law, **keywords):
    """An arm behind a gear, whose motor moves by samples; ``law(ratio, lead, duration)`` is its
    motion.
    """
    m = Mechanism("geared")
    ratio = m.parameter("ratio", 2.0)
    lead = m.parameter("lead", 0.0, "rad")
    duration = m.parameter("duration", 1.0, "s", low=0.1)
    m.revolute("J", m.ground, m.link("arm", length=0.5, mass=1.0))
    return Scene(m, {"J": law(ratio, lead, duration)}, **{"t": (0, 1, 57)} | keywords)


LAWS = {
    "vector": lambda ratio, lead, duration: motion.samples(TIMES, ratio * ANGLES),
    "list": lambda ratio, lead, duration: motion.samples(
        list(TIMES), [ratio * angle for angle in ANGLES]
    ),
    "divided": lambda ratio, lead, duration: motion.samples(
        TIMES, [angle / ratio + lead for angle in ANGLES]
    ),
    "later": lambda ratio, lead, duration: motion.samples(
        [duration * t for t in TIMES], [-angle * ratio - lead for angle in ANGLES]
    ),
    "times": lambda ratio, lead, duration: motion.samples(duration * TIMES, ANGLES),
}
NUMBERS = {
    "vector": lambda r, a, T: (TIMES, r * ANGLES),
    "list": lambda r, a, T: (TIMES, r * ANGLES),
    "divided": lambda r, a, T: (TIMES, ANGLES / r + a),
    "later": lambda r, a, T: (T * TIMES, -ANGLES * r - a),
    "times": lambda r, a, T: (T * TIMES, ANGLES),
}


@pytest.mark.sampled(5)
@pytest.mark.parametrize("name", LAWS)
def test_samples_scaled_by_parameters_are_those_of_scaled_numbers(name):
    scene = geared(LAWS[name])
    rows = np.array([[2.0, 0.0, 1.0], [-0.7, 0.3, 1.5], [3.1, -1.0, 2.0]])
    designs = DesignEngine.of(scene).evaluate(rows)
    assert designs.status.tolist() == [Status.OK] * 3
    names = [str(quantity) for quantity in DesignEngine.of(scene).quantities]
    for k, row in enumerate(rows):
        found = evaluate(
            scene, parameters=dict(zip(("ratio", "lead", "duration"), row, strict=True))
        )
        numbers = evaluate(
            geared(lambda *_, row=row: motion.samples(*NUMBERS[name](*row))), backend="vm"
        )
        assert found.certified
        for quantity in numbers.names():
            size = np.abs(numbers.array(quantity)).max() or 1.0
            np.testing.assert_allclose(
                found.array(quantity),
                numbers.array(quantity),
                rtol=0,
                atol=1e-10 * size,
                err_msg=quantity,
            )
        (peak,) = refine(scene, found, ["effort:J"])
        assert abs(designs.value[k, names.index("effort:J")] - peak.value) <= 1e-9 * abs(peak.value)


def test_a_cycle_that_ends_before_the_scene_is_refused():
    scene = geared(LAWS["times"])
    with pytest.raises(
        DeclarationError, match=r"motion of joint 'J': .* outside the curve's range at t = 0\.5"
    ):
        evaluate(scene, parameters={"duration": 0.5})
    assert DesignEngine.of(scene).evaluate(
        np.array([[2, 0, 1.0], [2, 0, 0.5]])
    ).status.tolist() == [Status.OK, Status.BEYOND_ENDS]


def test_the_third_derivative_is_that_of_the_pieces():
    scene = geared(LAWS["vector"])
    p = scene.mechanism.symbols
    jerk = Laws.of(scene.motion, p).jerk()
    plain = Laws.of({"J": motion.samples(TIMES, 2.0 * ANGLES)}, ca.SX(0, 1)).jerk()
    for t in (0.05, 0.33, 0.5, 0.99):
        assert float(jerk(t, [2.0, 0.0, 1.0])) == pytest.approx(float(plain(t, [])), rel=1e-9)


def test_a_row_is_taken_apart_only_as_far_as_it_is_alike():
    p, q = ca.SX.sym("p"), ca.SX.sym("q")
    row = Scaled.of("row", [p * q * x - q for x in (1.0, 2.0, 5.0)])
    back = ca.Function("back", [p, q], [row.shift + row.scale * n for n in row.numbers])
    assert [float(x) for x in back(3.0, 7.0)] == pytest.approx([14.0, 35.0, 98.0], rel=1e-14)
    assert Scaled.of("row", [1.0, 2.0]).scale is None
    assert Scaled.of("row", ca.SX([1.0, 2.0])).numbers == [1.0, 2.0]
    with pytest.raises(
        DeclarationError, match="row: parameters may only scale and shift all of them together"
    ):
        Scaled.of("row", [p, q, p + q, 1.0])
    with pytest.raises(
        DeclarationError,
        match=r"motion samples: values: parameters may only scale .* lagrange_casadi\.curve",
    ):
        motion.samples([0, 1, 2, 3], [0, p, q, p * p])
    with pytest.raises(DeclarationError, match="places must increase"):
        motion.samples([0, p, 0.5 * p, 2 * p], [0, 1, 2, 3])


@pytest.mark.parametrize(
    "law",
    [
        lambda ratio, lead, duration: motion.polynomial(lead, ratio / duration, ratio * lead),
        lambda ratio, lead, duration: motion.harmonic(lead, ratio, 1 / duration, ratio * lead),
        lambda ratio, lead, duration: motion.expression(
            lambda t: ratio * ca.sin(t / duration) + lead
        ),
    ],
)
def test_every_law_takes_expressions_of_parameters(law):
    scene = geared(law)
    values = {"ratio": 1.3, "lead": 0.2, "duration": 0.8}
    found = evaluate(scene, parameters=values)
    numbers = evaluate(geared(lambda *_: law(*values.values())))
    for name in numbers.names():
        np.testing.assert_allclose(found.array(name), numbers.array(name), rtol=1e-12, atol=1e-12)


def test_a_parameter_of_another_mechanism_is_named():
    other = ca.SX.sym("speed")
    with pytest.raises(
        DeclarationError, match="the motion of joint 'J' depends on 'speed', not a parameter"
    ):
        evaluate(geared(lambda *_: motion.samples(TIMES, other * ANGLES)))
