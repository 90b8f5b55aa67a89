"""The derivatives of a solution in a file: under /sensitivity/PARAMETER the same places that what
they are of has under /.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import h5py
import numpy as np

from ...base.arrays import Array
from ...base.quantities import Output
from ...model.wanted_names import SENSITIVITY
from ..derivatives import Derivatives, derivatives
from ..histories import Histories
from ..solution import Solution
from .dataset_words import say
from .scales import Scales


def add_slopes(
    file: h5py.File,
    scales: Scales,
    solution: Solution,
    create: Callable[[str, tuple[int, ...]], h5py.Dataset],
) -> None:
    """Write all; ``create`` makes an empty dataset at a place, of a shape."""
    for found in derivatives(solution, solution.sensitivities):
        dataset = create(_place(found.name), found.values.shape)
        dataset[...] = found.values
        say(dataset, found.unit, found.attributes)
        scales.attach(dataset, found.output.quantity.axes)


def slopes_of(
    file: h5py.File, histories: Histories, numbers: Callable[[h5py.Dataset, tuple[int, ...]], Array]
) -> Derivatives:
    """Read the sensitivities of a file; ``numbers`` reads a dataset of a shape.

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
    expected_names = {
        f"{name}/{str(o).replace(':', '/')}": (name, o) for name in group for o in expected
    }
    if set(places) != set(expected_names):
        raise ValueError("the sensitivities are not of all quantities")
    for place, (name, output) in expected_names.items():
        shape = tuple(lengths[axis] for axis in output.quantity.axes)
        found.setdefault(name, {})[output] = numbers(group[place], shape)
    return Derivatives(
        {name: found[name] for name in histories.description.parameters if name in found}
    )


def check_slopes(file: h5py.File, solution: Solution) -> Iterator[str]:
    """Faults of a file's sensitivities: they must be finite where their quantities are, in their
    units, on their axes.
    """
    for found in derivatives(solution, solution.sensitivities):
        place, rests = (
            _place(found.name),
            solution.resting.reshape(-1, *[1] * (found.values.ndim - 1)),
        )
        if not (np.isfinite(found.values) | (rests & np.isnan(found.values))).all():
            yield f"{place}: values that are not finite"
        for key, value in ({"units": found.unit} | found.attributes).items():
            if file[place].attrs.get(key) != value:
                yield f"{place}: {key} differs from the schema"
        for axis, scale in enumerate(found.output.quantity.axes):
            if file[scale] not in file[place].dims[axis].values():
                yield f"{place}: axis {axis} has no scale /{scale}"


def _place(name: str) -> str:
    return name.replace(":", "/")
