"""The derivatives of a solution in a file: under /sensitivity/PARAMETER the same places that what
they are of has under /.
"""

from __future__ import annotations

import h5py

from ...base.arrays import Array
from ...base.quantities import Output
from ...model.wanted_names import SENSITIVITY
from ..derivatives import Derivatives
from ..histories import Histories
from .dataset_words import place_of
from .untrusted import numbers


def slopes_of(file: h5py.File, histories: Histories) -> Derivatives:
    """Read the sensitivities of a file.

    Raises ``ValueError`` where it is not whole.
    """
    group = file.get(SENSITIVITY, {})
    lengths = {"t": histories.t.size, "xi": histories.xi.size}
    expected = [output for output in histories.quantities() if histories.determined(output)]
    found: dict[str, dict[Output, Array]] = {}
    places: list[str] = []
    if group:
        group.visititems(
            lambda place, item: places.append(place) if isinstance(item, h5py.Dataset) else None
        )
    if set(group) - histories.description.parameters.keys():
        raise ValueError("there are sensitivities by names that are not parameters")
    expected_names = {f"{name}/{place_of(o)}": (name, o) for name in group for o in expected}
    if set(places) != set(expected_names):
        raise ValueError("the sensitivities are not of all quantities")
    for place, (name, output) in expected_names.items():
        shape = tuple(lengths[axis] for axis in output.quantity.axes)
        found.setdefault(name, {})[output] = numbers(group[place], shape)
    return Derivatives(
        {name: found[name] for name in histories.description.parameters if name in found}
    )
