"""Scores of fatigue on drawn histories of stresses: no score is above its bound, and between two
histories the bound is no larger than at both; of normal stress alone a bound that is exact is the
score.
"""

import numpy as np
import pytest
from internals import fatigue, plane_score

from lagrange_casadi import beams

pytestmark = pytest.mark.quick

STEEL = beams.material("C45+QT").but(endurance=1.5e8)
SCORES = {
    "damage": fatigue.damage_score(STEEL),
    "use": fatigue.use_score(STEEL),
    "use, gerber": fatigue.use_score(STEEL, "gerber"),
    "use, soft": fatigue.use_score(STEEL.but(endurance=6e8)),
    "plane": plane_score(),
}


def drawn(draw):
    """Histories of any means, of which shear stresses may be zero or all."""
    count, size = draw.integers(2, 12), 10 ** draw.uniform(6.5, 8.2)
    parts = draw.choice([0.0, 0.3, 1.0], (3, 1)) * [[1], [0.6], [0.6]]
    return size * parts * (draw.normal(size=(3, count)) + draw.choice([0, 1, 3]) * draw.normal())


@pytest.mark.parametrize("name", SCORES)
def test_no_score_is_above_its_bound(name):
    score, draw, close = SCORES[name], np.random.default_rng(3), 0
    for _ in range(200):
        values = drawn(draw)
        other = values + drawn(draw)[:, :1] * draw.uniform(-1, 1, values.shape)
        found, bound = score.of(values), float(score.bound(values))
        assert found <= bound + 1e-11 * abs(bound)
        close += found >= bound - 0.4 * abs(bound)
        largest = max(bound, float(score.bound(other)))
        assert score.bound((values + other) / 2) <= largest + 1e-11 * abs(largest)
        alone = values[:1]
        if score.exact and alone.any():
            assert score.bound(alone) == pytest.approx(
                score.of(np.vstack([alone, 0 * alone, 0 * alone])), rel=1e-12
            )
    assert close > 20
