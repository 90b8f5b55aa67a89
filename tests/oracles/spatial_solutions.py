"""Solutions of drawn mechanisms in space, each made once, and what their certificates say."""

import functools

from balls import platform
from spatial_anyhow import anyhow
from spatial_bridge import declared, plain
from spatial_draft import turning
from spatial_mechanisms import FAMILIES
from spatial_wheels import wheel

from lagrange_casadi import evaluate

DRAWS = FAMILIES | {"anyhow": anyhow, "wheel": wheel, "locked": platform}


@functools.cache
def scene_of(name, seed):
    """What was drawn, and its scene."""
    drawn = turning(plain(DRAWS[name](seed)), seed)
    return drawn, declared(drawn, beside=True, xi=(0, 1, 5))


@functools.cache
def evaluated(name, seed):
    """What was drawn, and its solution."""
    drawn, scene = scene_of(name, seed)
    return drawn, evaluate(scene)


def residuals(certificate):
    """The largest of each residual."""
    return {
        name: float(values.max()) for name, values in certificate.items() if name != "condition"
    }
