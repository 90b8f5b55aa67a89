"""A mechanism in motion as glTF 2.0 in one binary file (.glb), for presentations, Blender and
viewers of three dimensions.

Bodies are solids that move as a whole: each is a node, whose translation and rotation have a key at
every instant that is shown. See the specification of glTF 2.0 by the Khronos Group, sections 3
(concepts) and 4 (the binary container).
"""

from __future__ import annotations

import json
import struct
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from ...base.arrays import Array
from ...model.description import JointNumbers
from ...results.solution import Solution
from ...version import __version__
from ..shapes.orthographic import upright
from ..shapes.poses import Poses, frame_along
from ..shapes.primitives import disc_axis, drawing, size_of
from ..shapes.shapes import Shape, shapes
from ..shapes.symbols import PATH
from .forces import ACTION_COLOURS, LONGEST, actions_of
from .solids import Mesh, arrow, block, cylinder, prism, sphere, together

_GIRTH = 0.013
"""Half the width of a link, over the mechanism's size."""

_NOTHING, _LEAST = 1e-9, 1e-6
"""Over the largest: a force that is none.

Over the mechanism's size: the least length of an arrow, for none has a length of 0.
"""

_METAL, _STILL, _SPRING = "#c3cad3", "#8a929c", "#6a7078"
_FLOAT, _WHOLE, _POINTS, _CORNERS, _LINE, _TRIANGLES = 5126, 5125, 34962, 34963, 3, 4


def glb(solution: Solution, frames: int, seconds: float, *, forces: bool = False) -> bytes:
    """The file: one cycle in so many ``seconds``, with at most ``frames`` keys and one more.

    With ``forces`` it has arrows of reactions, efforts and loads. Raises :class:`.DeclarationError`
    where none of the forces that are asked for is known.
    """
    t = solution.t
    keyed = np.linspace(0, t.size - 1, min(t.size, frames + 1)).round()
    shown = solution.during(np.isin(np.arange(t.size), keyed))
    size = size_of(drawing(Poses.of(solution)))
    poses = Poses.of(shown)
    file = _File()
    file.keys = file.array((shown.t - t[0]) / (t[-1] - t[0]) * seconds)
    parts = [*_bodies(file, poses, _GIRTH * size), *_still(file, poses, _GIRTH * size)]
    if forces:
        parts += _actions(file, shown, poses, size)
    rotation = None
    if solution.description.space:
        right, away, up = upright(solution.description.gravity)
        # Up is y there, and what is near z.
        rotation = _quaternions(np.stack([right, up, -away])[None])[0].tolist()
    file.node(solution.case, children=parts, rotation=rotation)
    return file.made(solution.case)


@dataclass(eq=False)
class _File:
    """Contents of a file as they are added: lists by their names, and the bytes of the arrays."""

    content: dict[str, list[Any]] = field(default_factory=dict)
    channels: list[Any] = field(default_factory=list)
    samplers: list[Any] = field(default_factory=list)
    data: bytearray = field(default_factory=bytearray)
    keys: int = 0

    def add(self, kind: str, entry: dict[str, Any]) -> int:
        """The number of an entry in the list of a kind."""
        entries = self.content.setdefault(kind, [])
        entries.append(entry)
        return len(entries) - 1

    def array(self, values: npt.NDArray[np.generic], target: int | None = None) -> int:
        """An array, (n,) or (n, 3 or 4): of whole numbers, or in single precision."""
        whole = values.dtype.kind in "iu"
        values = values.astype("<u4") if whole else values.astype("<f4") + np.float32(0.0)
        view = {"buffer": 0, "byteOffset": len(self.data), "byteLength": values.nbytes}
        self.data += values.tobytes()
        rows = values.reshape(len(values), -1)
        accessor = {
            "bufferView": self.add("bufferViews", view | ({"target": target} if target else {})),
            "componentType": _WHOLE if whole else _FLOAT,
            "count": len(values),
            "type": "SCALAR" if values.ndim == 1 else f"VEC{values.shape[1]}",
            "min": rows.min(axis=0).tolist(),
            "max": rows.max(axis=0).tolist(),
        }
        return self.add("accessors", accessor)

    def material(self, colour: str) -> int:
        """A surface of a colour, once."""
        known = [material["name"] for material in self.content.get("materials", ())]
        if colour in known:
            return known.index(colour)
        share = np.array([int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)])
        linear = np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)
        surface = {
            "baseColorFactor": [*linear.round(6).tolist(), 1.0],
            "metallicFactor": 0.2,
            "roughnessFactor": 0.6,
        }
        return self.add("materials", {"name": colour, "pbrMetallicRoughness": surface})

    def mesh(self, name: str, mesh: Mesh, colour: str) -> int:
        """A solid of a colour."""
        places, normals = self.array(mesh.places, _POINTS), self.array(mesh.normals, _POINTS)
        primitive = {
            "attributes": {"POSITION": places, "NORMAL": normals},
            "indices": self.array(mesh.corners.ravel(), _CORNERS),
            "mode": _TRIANGLES,
            "material": self.material(colour),
        }
        return self.add("meshes", {"name": name, "primitives": [primitive]})

    def node(self, name: str, moves: dict[str, Array] | None = None, **more: Any) -> int:
        """A node, and what ``moves`` it at the keys: translations, rotations and scales."""
        filled = {key: value for key, value in more.items() if value not in (None, [])}
        number = self.add("nodes", {"name": name} | filled)
        for path, values in (moves or {}).items():
            output = self.array(values)
            self.samplers.append({"input": self.keys, "output": output, "interpolation": "LINEAR"})
            self.channels.append(
                {"sampler": len(self.samplers) - 1, "target": {"node": number, "path": path}}
            )
        return number

    def made(self, name: str) -> bytes:
        """The bytes of the file; its top is the last node."""
        content = {
            "asset": {"version": "2.0", "generator": f"lagrange_casadi {__version__}"},
            "scene": 0,
            "scenes": [{"name": name, "nodes": [len(self.content["nodes"]) - 1]}],
            **self.content,
            "animations": [{"name": "cycle", "channels": self.channels, "samplers": self.samplers}],
            "buffers": [{"byteLength": len(self.data)}],
        }
        text = json.dumps(content, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        body = bytes(self.data) + b"\0" * (-len(self.data) % 4)
        head = struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(body))
        heads = struct.pack("<II", len(text), 0x4E4F534A), struct.pack("<II", len(body), 0x004E4942)
        return b"".join([head, heads[0], text, heads[1], body])


def _bodies(file: _File, poses: Poses, girth: float) -> Iterator[int]:
    """The bodies, each with its joints' pins."""
    description = poses.description
    for shape in shapes(description):
        pins = [
            file.node(name, mesh=file.mesh(name, _pin(joint, poses, girth), _METAL))
            for name, joint in description.joints.items()
            if joint.child.body == shape.name
        ]
        solid = together(list(_solids(shape, poses, girth)))
        mesh = file.mesh(shape.name, solid, poses.colours[shape.name])
        moves = {"translation": poses.bases[shape.name]}
        if shape.kind != "point":
            moves["rotation"] = _quaternions(poses.axes[shape.name].transpose(0, 2, 1))
        yield file.node(shape.name, moves, mesh=mesh, children=pins)


def _still(file: _File, poses: Poses, girth: float) -> Iterator[int]:
    """Springs as rods, blocks under joints on the ground, and the ways of declared points."""
    description = poses.description
    rod = cylinder(np.zeros(3), np.eye(3)[0], 0.4 * girth)
    for name, (start, stop) in description.springs.items():
        base = poses.place(start)
        ways = poses.place(stop) - base
        scales = np.linalg.norm(ways, axis=1)[:, None] * [1.0, 0.0, 0.0] + [0.0, 1.0, 1.0]
        moves = {"translation": base, "rotation": _along(ways), "scale": scales}
        yield file.node(name, moves, mesh=file.mesh(name, rod, _SPRING))
    down = -upright(description.gravity)[2]
    for name, joint in description.joints.items():
        if joint.parent.body == "ground" and joint.kind != "free":
            place = np.array(joint.parent.at) + 2.2 * girth * down
            foot = block(place, frame_along(down), [girth, 5 * girth, 5 * girth])
            yield file.node(f"{name}, ground", mesh=file.mesh(name, foot, _STILL))
    for name, spot in description.paths.items():
        line = {
            "attributes": {"POSITION": file.array(poses.place(spot), _POINTS)},
            "mode": _LINE,
            "material": file.material(PATH),
        }
        mesh = file.add("meshes", {"name": name, "primitives": [line]})
        yield file.node(f"way of {name}", mesh=mesh)


def _actions(file: _File, solution: Solution, poses: Poses, size: float) -> Iterator[int]:
    """Reactions, efforts and loads as arrows of length 1, which are placed, turned and made as long
    as they are large.
    """
    for unit, actions, largest in actions_of(solution, poses):
        if not largest:
            continue
        scale = LONGEST * size / largest
        heads = 2 if unit == "N m" else 1
        meshes = {
            kind: file.mesh("arrow", arrow(heads), ACTION_COLOURS[kind])
            for kind in dict.fromkeys(one.kind for one in actions)
        }
        for one in actions:
            sizes = np.linalg.norm(one.vector, axis=1)
            # What is nothing has no direction; it keeps the one before.
            there = np.where(sizes > _NOTHING * largest, np.arange(sizes.size), 0)
            moves = {
                "translation": one.place - scale * one.vector if one.kind == "load" else one.place,
                "rotation": _along(one.vector[np.maximum.accumulate(there)]),
                "scale": np.tile(np.maximum(scale * sizes, _LEAST * size)[:, None], 3),
            }
            extras = {"unit": unit, "metres_per_unit": scale, "largest": float(sizes.max())}
            yield file.node(f"{one.kind} {one.of}", moves, mesh=meshes[one.kind], extras=extras)


def _solids(shape: Shape, poses: Poses, girth: float) -> Iterator[Mesh]:
    """A body: its axis and arms as rods, its plates, its disc; one that has none as a block."""
    for start, stop in [shape.axis] * bool(shape.axis) + list(shape.arms):
        if start != stop:
            yield cylinder(np.array(start), np.array(stop), girth)
    for corners in shape.plates:
        yield prism(np.array(corners), 1.2 * girth)
    axis, centre = disc_axis(poses, shape), np.array(shape.centre or (0.0, 0.0, 0.0))
    if axis is not None:
        yield cylinder(centre - 0.6 * girth * axis, centre + 0.6 * girth * axis, shape.disc)
    elif not (shape.axis or shape.arms or shape.plates):
        yield block(centre, np.eye(3), [5 * girth, 4 * girth, 4 * girth])


def _pin(joint: JointNumbers, poses: Poses, girth: float) -> Mesh:
    """A joint on its child: a ball, a block that slides along an axis, or a pin along it."""
    at = np.array(joint.child.at)
    if joint.kind in ("spherical", "free"):
        return sphere(at, 1.5 * girth)
    ground = poses.direction(joint.parent.body, joint.triad[0])[0]
    axis = ground if joint.child.body == "ground" else poses.axes[joint.child.body][0] @ ground
    if joint.kind in ("prismatic", "planar"):
        return block(at, frame_along(axis), [4.4 * girth, 2.6 * girth, 2.6 * girth])
    # The pin of a planar slot is across the plane, and not along the slot.
    half = 1.6 * girth * (np.eye(3)[2] if joint.kind == "slot" else axis)
    return cylinder(at - half, at + half, 1.1 * girth)


def _along(ways: Array) -> Array:
    """Quaternions (n, 4) that turn x to directions (n, 3); of nothing, to x."""
    frames = frame_along(np.where(ways.any(axis=1, keepdims=True), ways, np.eye(3)[0]))
    return _quaternions(frames.transpose(0, 2, 1))


def _quaternions(axes: Array) -> Array:
    """Rotations (n, 3, 3), whose columns are turned axes, as x, y, z, w (n, 4), each on the side of
    the one before.
    """
    from scipy.spatial.transform import Rotation

    found = Rotation.from_matrix(axes).as_quat()
    signs = np.cumprod(np.where(np.sum(found[1:] * found[:-1], axis=1) < 0.0, -1.0, 1.0))
    return np.asarray(found * np.concatenate([[1.0], signs])[:, None])
