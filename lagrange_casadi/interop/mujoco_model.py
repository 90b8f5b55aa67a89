"""Models that MuJoCo has compiled, as plain numbers: what is returned to another process, which
imports no more of the package than this.
"""

from __future__ import annotations

import re
from types import ModuleType
from typing import TYPE_CHECKING

import numpy as np

from ..base.arrays import Array
from ..errors import MissingPackageError, one_line

if TYPE_CHECKING:
    from mujoco import MjModel

Value = Array | float

_PLAIN = """
<mujoco><worldbody><geom size="1"/><site/><body><geom size="1"/><joint/></body></worldbody></mujoco>
"""
"""A model of one thing of each kind that lies in the tree of bodies, all as MuJoCo's defaults."""


def compiled(file: str, fields: list[str], usual: str) -> dict[str, object]:
    """Return what a model is compiled to.

    Parameters
    ----------
    file
        The model; files that it names are in the current folder.
    fields
        Names of arrays of ``MjModel``, options as ``opt.gravity``.
    usual
        Pattern of the fields without effect.

    Returns
    -------
    dict
        ``fields`` by name, with places and axes of bodies, ``xpos`` and ``xmat``, in the reference
        posture; ``names`` of objects by kind; ``kinds`` of equalities, of what they join and of
        transmissions, as words; and ``others``, the fields besides these that are not as MuJoCo has
        them by default, switched flags too.
        ``refused`` is MuJoCo's message, alone, for what it does not compile.

    Raises
    ------
    MissingPackageError
        Without MuJoCo.
    """
    try:
        import mujoco
    except ImportError as error:
        broken = "" if isinstance(error, ModuleNotFoundError) else f"; it is broken here: {error}"
        raise MissingPackageError(
            f"a model of MuJoCo is compiled by MuJoCo: pip install mujoco{broken}"
        ) from None
    try:
        model = mujoco.MjModel.from_xml_path(file)
        data = mujoco.MjData(model)
        mujoco.mj_kinematics(model, data)
    except (ValueError, mujoco.FatalError) as error:
        return {"refused": one_line(error)}
    values, plain = _values(mujoco, model), _values(mujoco, mujoco.MjModel.from_xml_string(_PLAIN))
    posture = {"xpos": data.xpos.tolist(), "xmat": data.xmat.tolist()}
    return {
        "name": model.names.partition(b"\0")[0].decode(errors="replace"),  # its own is the first
        "fields": posture
        | {name: np.asarray(values[name]).tolist() for name in fields if name in values},
        "names": {
            kind: [mujoco.mj_id2name(model, number, k) for k in range(count)]
            for kind, number, count in (
                ("body", mujoco.mjtObj.mjOBJ_BODY, model.nbody),
                ("joint", mujoco.mjtObj.mjOBJ_JOINT, model.njnt),
                ("equality", mujoco.mjtObj.mjOBJ_EQUALITY, model.neq),
                ("site", mujoco.mjtObj.mjOBJ_SITE, model.nsite),
            )
        },
        "kinds": {
            name: [known(int(one)).name.partition("_")[2] for one in np.asarray(values[name])]
            for name, known in (
                ("eq_type", mujoco.mjtEq),
                ("eq_objtype", mujoco.mjtObj),
                ("actuator_trntype", mujoco.mjtTrn),
            )
        },
        "others": [
            name
            for name, value in values.items()
            if name not in fields
            and not re.fullmatch(usual, name)
            and _differs(value, plain.get(name))
        ],
    }


def _values(mujoco: ModuleType, model: MjModel) -> dict[str, Value]:
    """Return the arrays and switches of a model, its options and flags by name."""
    values = {name: getattr(model, name) for name in dir(model)}
    values |= {f"opt.{name}": getattr(model.opt, name) for name in dir(model.opt)}
    for word, flags, bits in (
        ("disable", model.opt.disableflags, mujoco.mjtDisableBit),
        ("enable", model.opt.enableflags, mujoco.mjtEnableBit),
    ):
        values |= {
            f"{word} {name.partition('_')[2].lower()}": bool(flags & int(bit))
            for name, bit in bits.__members__.items()
            if int(bit).bit_count() == 1 and not name.startswith("mjN")
        }
    return {
        name: value
        for name, value in values.items()
        if not name.startswith("_") and isinstance(value, bool | int | float | np.ndarray)
    }


def _differs(value: Value, plain: Value | None) -> bool:
    """Return whether a field is not as by default: a row of an array is not as the last one of the
    plain model, or is not zero if that has none.
    """
    if isinstance(plain, np.ndarray):
        plain = plain[-1] if len(plain) else None
    return bool(np.any(value) if plain is None else np.any(value != plain))
