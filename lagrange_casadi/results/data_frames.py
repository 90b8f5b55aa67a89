"""Histories in the containers of other libraries, and as rows: an instant each, with units in the
head.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from ..base.arrays import Array
from ..base.packages import check_installed
from ..base.table_writers import head
from .derivatives import Derivatives, Series, derivatives
from .histories import Histories

if TYPE_CHECKING:
    import pandas
    import xarray

TIME = "t [s]"
"""The head of the instants."""


def dataset(histories: Histories, sensitivities: Derivatives) -> xarray.Dataset:
    """All quantities as an ``xarray.Dataset`` over t and xi.

    Raises :class:`.LagrangeCasadiError` without xarray.
    """
    check_installed("xarray", "to_xarray")
    import xarray

    data = {
        one.name: (one.output.quantity.axes, one.values, {"units": one.unit} | one.attributes)
        for one in _everything(histories, sensitivities)
    }
    coordinates = {
        "t": ("t", histories.t, {"units": "s"}),
        "xi": ("xi", histories.xi, {"units": "1", "long_name": "ratio xi/l"}),
    }
    if histories.over:
        coordinates["over"] = (
            "t",
            histories.over.values,
            {"units": histories.over.unit, "long_name": histories.over.long_name},
        )
    return xarray.Dataset(data, coordinates, {"case": histories.case})


def frame(histories: Histories, sensitivities: Derivatives) -> pandas.DataFrame:
    """All quantities as a ``pandas.DataFrame``, a row an instant.

    Raises :class:`.LagrangeCasadiError` without pandas.
    """
    check_installed("pandas", "to_pandas")
    import pandas

    return pandas.DataFrame(
        columns(histories, sensitivities), index=pandas.Index(histories.t, name=TIME)
    )


def columns(histories: Histories, sensitivities: Derivatives) -> dict[str, Array]:
    """All quantities over the instants, (t,), by a head with the unit: ``effort:O [N m]``.

    A section force has a column for each ratio: ``section:LINK:bending xi/l=0.25 [N m]``.
    """
    found: dict[str, Array] = {}
    if histories.over:
        found[head(f"over:{histories.over.joint}", histories.over.unit)] = histories.over.values
    for one in _everything(histories, sensitivities):
        if one.values.ndim == 1:
            found[head(one.name, one.unit)] = one.values
        else:
            found |= {
                head(f"{one.name} xi/l={xi:.10g}", one.unit): column
                for xi, column in zip(histories.xi, one.values.T, strict=True)
            }
    return found


def _everything(histories: Histories, sensitivities: Derivatives) -> Iterator[Series]:
    """All quantities, and then their derivatives."""
    for output in histories.quantities():
        yield Series(
            str(output),
            output,
            histories.array(output),
            histories.unit(output),
            output.meant(histories.table).attributes,
        )
    yield from derivatives(histories, sensitivities)
