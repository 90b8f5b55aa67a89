"""Links that are compliant, if elasticity determines what equilibrium leaves indeterminate."""

from __future__ import annotations

from collections.abc import Sequence

from ..errors import DeclarationError, UnknownNameError
from .density import Density
from .mechanism import Mechanism

Elastic = bool | Sequence[str]


def compliant_links(mechanism: Mechanism, elastic: Elastic) -> Elastic:
    """Check the scene's ``elastic``: no, yes, or the compliant links, in their order.

    Raises :class:`.UnknownNameError` for what is no link, and :class:`.DeclarationError` for a link
    that has no beam, or a material without elasticity.
    """
    if isinstance(elastic, bool):
        return elastic
    if not isinstance(elastic, (list, tuple)) or not all(isinstance(name, str) for name in elastic):
        raise DeclarationError(
            f"elastic: expected True, or a list of the links that are elastic, got {elastic!r}"
        )
    having = [
        name
        for name, link in mechanism.links.items()
        if isinstance(link.mass, Density) and link.beam is not None
    ]
    for name in elastic:
        if name not in mechanism.links:
            raise UnknownNameError("link in elastic", name, having)
        beam = mechanism.links[name].beam
        if name not in having or beam is None:
            raise DeclarationError(
                f"elastic: link '{name}' has no beam=; links with a beam:"
                f" {', '.join(having) or 'none'}"
            )
        beam.material.needs(f"elastic link '{name}'", "elasticity")
    return tuple(name for name in having if name in elastic)
