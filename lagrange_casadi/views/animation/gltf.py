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

from ...base.arrays import Array, Json
from ...errors import DeclarationError
from ...model.description import JointNumbers, Place
from ...results.solution import Solution
from ...version import __version__
from ..shapes.places import drawn_spots, placed
from ..shapes.shapes import Shape, shapes
from ..shapes.solid import COLOURS, PATH
from ..shapes.views import upright
from .forces import LONGEST, actions_of, largest_of
from .motion import Motion
from .solids import Mesh, arrow, block, cylinder, frame_along, prism, sphere, together

_KEPT = ("nodes", "meshes", "materials", "accessors", "bufferViews")
"""Lists of a file, in the order in which they stand there."""

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
    where there are not two instants, and where none of the forces that are asked for is known.
    """
    if solution.t.size < 2:
        raise DeclarationError(
            f"{solution.case}: an animation shows a motion, and there is 1 instant; ask for more"
        )
    chosen = np.unique(
        np.linspace(0, solution.t.size - 1, min(solution.t.size, frames + 1)).round().astype(int)
    )
    return _Scene(solution, chosen, seconds, forces).made()


@dataclass(eq=False)
class _Scene:
    """Contents of a file as they are added: nodes, meshes, and the arrays of these."""

    solution: Solution
    chosen: npt.NDArray[np.intp]
    seconds: float
    forces: bool
    content: dict[str, list[Any]] = field(default_factory=lambda: {key: [] for key in _KEPT})
    channels: list[Any] = field(default_factory=list)
    samplers: list[Any] = field(default_factory=list)
    data: bytearray = field(default_factory=bytearray)

    def made(self) -> bytes:
        """The bytes of the file."""
        t = self.solution.t[self.chosen]
        self.keys = self._array((t - t[0]) / (t[-1] - t[0]) * self.seconds, ends=True)
        cloud = np.concatenate(
            [placed(self.solution, spot) for spot in drawn_spots(self.solution.description)]
        )
        self.size = float(np.max(np.ptp(cloud, axis=0))) or 1.0
        self.girth = _GIRTH * self.size
        parts = [
            *self._bodies(),
            *self._springs(),
            *self._still(),
            *(self._actions() if self.forces else ()),
        ]
        root: dict[str, Any] = {"name": self.solution.case, "children": parts}
        if self.solution.description.space:
            right, away, up = upright(self.solution.description.gravity)
            # Up is y there, and what is near z.
            root["rotation"] = _quaternions(np.stack([right, up, -away])[None])[0].tolist()
        top = self._node(root)
        content = {
            "asset": {"version": "2.0", "generator": f"lagrange_casadi {__version__}"},
            "scene": 0,
            "scenes": [{"name": self.solution.case, "nodes": [top]}],
            **self.content,
            "animations": [{"name": "cycle", "channels": self.channels, "samplers": self.samplers}],
            "buffers": [{"byteLength": len(self.data)}],
        }
        text = json.dumps(
            {key: value for key, value in content.items() if value}, separators=(",", ":")
        ).encode()
        text += b" " * (-len(text) % 4)
        body = bytes(self.data) + b"\0" * (-len(self.data) % 4)
        chunks = (
            struct.pack("<II", len(text), 0x4E4F534A)
            + text
            + struct.pack("<II", len(body), 0x004E4942)
            + body
        )
        return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks

    def _bodies(self) -> Iterator[int]:
        """The bodies, each with its joints' pins."""
        description = self.solution.description
        joints = list(description.joints.values())
        for k, shape in enumerate(shapes(description)):
            child_joints = [joint for joint in joints if joint.child.body == shape.name]
            solids = list(_solids(shape, self.girth))
            pins = [
                (joint.name, _pin(joint, self._axis(joint), self.girth)) for joint in child_joints
            ]
            children = [
                self._node({"name": name, "mesh": self._mesh(name, mesh, _METAL)})
                for name, mesh in pins
            ]
            node: dict[str, Any] = {"name": shape.name}
            if solids:
                node["mesh"] = self._mesh(shape.name, together(solids), COLOURS[k % len(COLOURS)])
            if children:
                node["children"] = children
            number = self._node(node)
            self._moves(
                number,
                "translation",
                placed(self.solution, Place(shape.name, (0.0, 0.0, 0.0)))[self.chosen],
            )
            if shape.kind != "point":
                self._moves(number, "rotation", _quaternions(self._axes(shape.name)))
            yield number

    def _springs(self) -> Iterator[int]:
        """Springs as rods of length 1, which are placed, turned and stretched."""
        for name, ends in self.solution.description.springs.items():
            start, stop = (placed(self.solution, end)[self.chosen] for end in ends)
            lengths = np.linalg.norm(stop - start, axis=1)
            axes = np.stack(
                [
                    frame_along(direction if direction.any() else np.eye(3)[0])
                    for direction in stop - start
                ]
            )
            rod = cylinder(np.zeros(3), np.eye(3)[0], 0.4 * self.girth)
            number = self._node({"name": name, "mesh": self._mesh(name, rod, _SPRING)})
            self._moves(number, "translation", start)
            self._moves(number, "rotation", _quaternions(axes.transpose(0, 2, 1)))
            self._moves(
                number,
                "scale",
                np.stack([lengths, np.ones_like(lengths), np.ones_like(lengths)], 1),
            )
            yield number

    def _actions(self) -> Iterator[int]:
        """Reactions, efforts and loads as arrows of length 1, which are placed, turned and made as
        long as they are large.
        """
        before = np.minimum(self.chosen, self.solution.t.size - 2)
        pushes, moments = actions_of(
            Motion(self.solution, before, (self.chosen - before).astype(float), closed=False)
        )
        for actions, unit, heads in ((pushes, "N", 1), (moments, "N m", 2)):
            largest = largest_of(actions)
            if not largest:
                continue
            scale = LONGEST * self.size / largest
            meshes = {
                colour: self._mesh("arrow", arrow(heads), colour)
                for colour in dict.fromkeys(one.colour for one in actions)
            }
            for one in actions:
                sizes = np.linalg.norm(one.vector, axis=1)
                # What is nothing has no direction; it keeps the one before.
                known = np.maximum.accumulate(
                    np.where(sizes > _NOTHING * largest, np.arange(sizes.size), 0)
                )
                directions = np.where(sizes[known, None] > 0.0, one.vector[known], np.eye(3)[0])
                axes = np.stack([frame_along(direction) for direction in directions])
                extras: Json = {
                    "unit": unit,
                    "metres_per_unit": scale,
                    "largest": float(sizes.max()),
                }
                number = self._node(
                    {"name": f"{one.kind} {one.of}", "mesh": meshes[one.colour], "extras": extras}
                )
                self._moves(
                    number, "translation", one.place if one.tail else one.place - scale * one.vector
                )
                self._moves(number, "rotation", _quaternions(axes.transpose(0, 2, 1)))
                self._moves(
                    number,
                    "scale",
                    np.tile(np.maximum(scale * sizes, _LEAST * self.size)[:, None], 3),
                )
                yield number

    def _still(self) -> Iterator[int]:
        """Draw fixed parts: blocks under joints on the ground, and the paths of declared points."""
        for joint in self.solution.description.joints.values():
            if joint.parent.body != "ground" or joint.kind == "free":
                continue
            down = -upright([*self.solution.description.gravity, 0.0][:3])[2]
            axes = frame_along(down)
            foot = block(
                np.array(joint.parent.at) + 2.2 * self.girth * down,
                axes,
                [self.girth, 5 * self.girth, 5 * self.girth],
            )
            yield self._node(
                {"name": f"{joint.name}, ground", "mesh": self._mesh(joint.name, foot, _STILL)}
            )
        for name, spot in self.solution.description.paths.items():
            direction = placed(self.solution, spot)[self.chosen]
            line = {
                "attributes": {"POSITION": self._array(direction, ends=True, target=_POINTS)},
                "mode": _LINE,
                "material": self._material(PATH),
            }
            self.content["meshes"].append({"name": name, "primitives": [line]})
            yield self._node({"name": f"way of {name}", "mesh": len(self.content["meshes"]) - 1})

    def _axis(self, joint: JointNumbers) -> Array:
        """The first axis of a joint, on its child's axes, at the first instant."""
        direction = np.array(joint.axes[0].direction if joint.axes else (0.0, 0.0, 1.0))
        ground = (
            direction
            if joint.parent.body == "ground"
            else self._axes(joint.parent.body)[0] @ direction
        )
        return np.asarray(
            ground if joint.child.body == "ground" else self._axes(joint.child.body)[0].T @ ground
        )

    def _axes(self, body: str) -> Array:
        """The axes of a body as columns (keys, 3, 3); those that it has not go with the others."""
        pose, count = self.solution.pose(body), self.chosen.size
        if pose.z is None and pose.angle is not None:
            c, s = np.cos(pose.angle[self.chosen]), np.sin(pose.angle[self.chosen])
            turned = np.array([[c, -s, 0 * c], [s, c, 0 * c], [0 * c, 0 * c, 0 * c + 1.0]])
            return np.asarray(turned.transpose(2, 0, 1))
        if pose.axes is None:
            return np.tile(np.eye(3), (count, 1, 1))
        axes = pose.axes[self.chosen]
        if np.isnan(axes).any():
            axes = np.stack([frame_along(direction) for direction in axes[:, 0]])
        return np.asarray(axes.transpose(0, 2, 1))

    def _node(self, node: dict[str, Json]) -> int:
        self.content["nodes"].append(node)
        return len(self.content["nodes"]) - 1

    def _mesh(self, name: str, mesh: Mesh, colour: str) -> int:
        attributes = {
            "POSITION": self._array(mesh.places, ends=True, target=_POINTS),
            "NORMAL": self._array(mesh.normals, target=_POINTS),
        }
        corners = self._array(mesh.corners.ravel().astype("<u4"), target=_CORNERS)
        primitive = {
            "attributes": attributes,
            "indices": corners,
            "mode": _TRIANGLES,
            "material": self._material(colour),
        }
        self.content["meshes"].append({"name": name, "primitives": [primitive]})
        return len(self.content["meshes"]) - 1

    def _material(self, colour: str) -> int:
        known = [material["name"] for material in self.content["materials"]]
        if colour not in known:
            share = np.array([int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)])
            linear = np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)
            surface = {
                "baseColorFactor": [*linear.round(6).tolist(), 1.0],
                "metallicFactor": 0.2,
                "roughnessFactor": 0.6,
            }
            self.content["materials"].append({"name": colour, "pbrMetallicRoughness": surface})
            known.append(colour)
        return known.index(colour)

    def _moves(self, node: int, path: str, values: Array) -> None:
        self.samplers.append(
            {"input": self.keys, "output": self._array(values), "interpolation": "LINEAR"}
        )
        self.channels.append(
            {"sampler": len(self.samplers) - 1, "target": {"node": node, "path": path}}
        )

    def _array(
        self, values: npt.NDArray[np.generic], *, ends: bool = False, target: int | None = None
    ) -> int:
        """Add an array, (n,) or (n, 3 or 4): of whole numbers, or in single precision; ``ends``
        states its least and largest.
        """
        values = values if values.dtype.kind == "u" else values.astype("<f4") + np.float32(0.0)
        view = {"buffer": 0, "byteOffset": len(self.data), "byteLength": values.nbytes} | (
            {"target": target} if target else {}
        )
        self.data += values.tobytes()
        self.content["bufferViews"].append(view)
        kind = "SCALAR" if values.ndim == 1 else f"VEC{values.shape[1]}"
        component = _WHOLE if values.dtype.kind == "u" else _FLOAT
        accessor = {
            "bufferView": len(self.content["bufferViews"]) - 1,
            "componentType": component,
            "count": len(values),
            "type": kind,
        }
        if ends:
            rows = values.reshape(len(values), -1)
            accessor |= {"min": rows.min(axis=0).tolist(), "max": rows.max(axis=0).tolist()}
        self.content["accessors"].append(accessor)
        return len(self.content["accessors"]) - 1


def _solids(shape: Shape, girth: float) -> Iterator[Mesh]:
    """A body: its axis and arms as rods, its plates, its disc; a point mass as a block."""
    if shape.kind == "point":
        yield block(np.zeros(3), np.eye(3), [5 * girth, 4 * girth, 4 * girth])
    for start, stop in [shape.axis] * bool(shape.axis) + list(shape.arms):
        if start != stop:
            yield cylinder(np.array(start), np.array(stop), girth)
    for corners in shape.plates:
        yield prism(np.array(corners), 1.2 * girth)
    if shape.disc and shape.centre:
        centre, half = np.array(shape.centre), 0.6 * girth * np.eye(3)[2]
        yield cylinder(centre - half, centre + half, shape.disc)


def _pin(joint: JointNumbers, axis: Array, girth: float) -> Mesh:
    """A joint on its child: a ball, a block that slides along an axis, or a pin along it."""
    at = np.array(joint.child.at)
    if joint.kind in ("spherical", "free"):
        return sphere(at, 1.5 * girth)
    if joint.kind in ("prismatic", "planar"):
        return block(at, frame_along(axis), [4.4 * girth, 2.6 * girth, 2.6 * girth])
    # The pin of a planar slot is across the plane, and not along the slot.
    direction = np.eye(3)[2] if joint.kind == "slot" else axis / np.linalg.norm(axis)
    return cylinder(at - 1.6 * girth * direction, at + 1.6 * girth * direction, 1.1 * girth)


def _quaternions(axes: Array) -> Array:
    """Rotations (n, 3, 3), whose columns are turned axes, as x, y, z, w (n, 4), each on the side of
    the one before.

    By the largest of four squares, so that nothing cancels: Shepperd, *Quaternion from rotation
    matrix*, Journal of Guidance and Control 1 (1978).
    """
    m = np.asarray(axes, float)
    trace = m[:, 0, 0] + m[:, 1, 1] + m[:, 2, 2]
    squares = np.stack([1.0 + 2.0 * m[:, k, k] - trace for k in range(3)] + [1.0 + trace], 1)
    products = np.empty((len(m), 4, 4))
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        products[:, i, j] = products[:, j, i] = m[:, i, j] + m[:, j, i]
        products[:, k, 3] = products[:, 3, k] = m[:, j, i] - m[:, i, j]
    products[:, range(4), range(4)] = squares
    best = products[np.arange(len(m)), np.argmax(squares, axis=1)]
    found = best / np.linalg.norm(best, axis=1)[:, None]
    signs = np.cumprod(np.where(np.sum(found[1:] * found[:-1], axis=1) < 0.0, -1.0, 1.0))
    return np.asarray(found * np.concatenate([[1.0], signs])[:, None])
