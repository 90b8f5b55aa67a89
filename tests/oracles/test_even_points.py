"""Even points: each is the double nearest to what the decimals of start and stop say, as long as
doubles hold the whole numbers of which it is a quotient; beyond, within four roundings.
"""

import random
from fractions import Fraction

import numpy as np
import pytest
from internals import points

pytestmark = pytest.mark.quick


@pytest.mark.parametrize("seed", range(4))
def test_points_are_what_decimals_say(seed):
    draw, exact = random.Random(seed), 0
    for _ in range(300):
        digits, count = draw.randint(0, 17), draw.randint(2, 40)
        start, stop = sorted(round(draw.choice([1, -1]) * draw.random(), digits) for _ in "ab")
        first, last = (Fraction(repr(end)) for end in (start, stop))
        each = [first + (last - first) * k / (count - 1) for k in range(count)]
        found = points((start, stop, count))
        whole = np.lcm.reduce([x.denominator for x in each], dtype=object)
        if max(abs(first), abs(last), 1) * whole <= 2**53:
            exact += 1
            assert found.tolist() == [float(x) for x in each]
        assert (found[0], found[-1]) == (start, stop)
        np.testing.assert_allclose(
            found, [float(x) for x in each], rtol=0, atol=4 * np.spacing(max(-start, stop))
        )
        assert points((start, stop, count), np.array([count - 1, 0])).tolist() == [stop, start]
    assert 50 < exact < 290
