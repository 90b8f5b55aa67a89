"""Long functions in parts: the same statements, the same bits."""

import numpy as np
import pytest
from compiled import columns
from mechanisms import slider_crank

from lagrange_casadi import codegen, derive
from lagrange_casadi.codegen import split

pytestmark = pytest.mark.quick


@pytest.mark.parametrize("language", ["c", "c++"])
def test_parts_give_the_same_bits(language, monkeypatch):
    graph, t = derive(slider_crank()), np.linspace(0, 0.08, 37)
    whole, text = columns(graph, t, language), codegen.emit(graph)
    for length in (7, 40):
        monkeypatch.setattr(split, "LENGTH", length)
        assert codegen.emit(graph).count("LAGRANGE_CASADI_PART void") > 50 / length
        assert np.array_equal(columns(graph, t, language), whole)
    assert "LAGRANGE_CASADI_PART void" not in text
