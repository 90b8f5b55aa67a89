"""The derivatives of a solution in a file: under /sensitivity/PARAMETER the same places that what
they are of has under /.
"""

from __future__ import annotations

from collections.abc import Mapping

import h5py

from ...base.arrays import Array
from ...base.quantities import Output
from ...model.wanted_names import SENSITIVITY
from ..derivatives import Derivatives
from ..histories import Histories
from .dataset_words import place_of
from .untrusted import numbers


def slopes_of(datasets: Mapping[str, h5py.Dataset], histories: Histories) -> Derivatives:
    """Read the sensitivities among the ``datasets`` of a file, by place.

    Raises ``ValueError`` where they are not whole.
    """
    kept = [place for place in datasets if place.startswith(f"{SENSITIVITY}/")]
    names, parameters = {place.split("/")[1] for place in kept}, histories.description.parameters
    if names - parameters.keys():
        raise ValueError("there are sensitivities by names that are not parameters")
    expected = {
        f"{SENSITIVITY}/{name}/{place_of(output)}": (name, output)
        for name in parameters
        if name in names
        for output in histories.quantities()
        if histories.determined(output)
    }
    if set(kept) != expected.keys():
        raise ValueError("the sensitivities are not of all quantities")
    lengths = {"t": histories.t.size, "xi": histories.xi.size}
    found: dict[str, dict[Output, Array]] = {}
    for place, (name, output) in expected.items():
        shape = tuple(lengths[axis] for axis in output.quantity.axes)
        found.setdefault(name, {})[output] = numbers(datasets[place], shape)
    return Derivatives(found)
