"""A frame solver by direct stiffness, which shares nothing with the package: Timoshenko's beams,
joints by multipliers.

Elements have the stiffness of textbooks (Przemieniecki, *Theory of Matrix Structural Analysis*,
section 5.6). Loads along an element are put to its nodes by the shape functions that solve the
unloaded beam, so displacements of nodes are exact.
"""

import itertools

import numpy as np

GAUSS = np.polynomial.legendre.leggauss(6)


def bending(l, ei, phi):
    """The stiffness of an element in a plane, for deflection and slope at both ends; ``phi`` is 12
    EI / (GAs l^2).
    """
    c = ei / (l**3 * (1 + phi))
    return c * np.array(
        [
            [12, 6 * l, -12, 6 * l],
            [6 * l, (4 + phi) * l * l, -6 * l, (2 - phi) * l * l],
            [-12, -6 * l, 12, -6 * l],
            [6 * l, (2 - phi) * l * l, -6 * l, (4 + phi) * l * l],
        ]
    )


def shapes(x, l, phi):
    """The deflections at a share x of an element for unit displacements of its ends."""
    c = 1 / (1 + phi)
    return np.array(
        [
            c * (1 - 3 * x**2 + 2 * x**3 + phi * (1 - x)),
            c * l * (x - 2 * x**2 + x**3 + phi / 2 * (x - x**2)),
            c * (3 * x**2 - 2 * x**3 + phi * x),
            c * l * (-(x**2) + x**3 - phi / 2 * (x - x**2)),
        ]
    )


class Frame:
    """Nodes with six displacements each, elements, ties, and what they add up to."""

    def __init__(self):
        self.places, self.elements, self.ties, self.loads = [], [], [], {}

    def node(self, place):
        self.places.append(np.asarray(place, float))
        return len(self.places) - 1

    def beam(self, a, b, axes, p, e, g, load=None):
        """An element between two nodes, in ``axes`` (rows x, y, z), of a cross-section; ``load`` of
        its share per length [N/m].
        """
        l = np.linalg.norm(self.places[b] - self.places[a])
        k, f = np.zeros((12, 12)), np.zeros(12)
        for stiffness, ends in ((e * p.area, (0, 6)), (g * p.torsion, (3, 9))):
            k[np.ix_(ends, ends)] += stiffness / l * np.array([[1, -1], [-1, 1]])
        # In the plane x, z a slope about y lowers z.
        for i, shear, across, turn, sign in (
            (p.iz, p.shear_y, 1, 5, 1),
            (p.iy, p.shear_z, 2, 4, -1),
        ):
            phi = 12 * e * i / (g * shear * l * l)
            ends, signs = [across, turn, across + 6, turn + 6], np.array([1, sign, 1, sign])
            k[np.ix_(ends, ends)] += bending(l, e * i, phi) * np.outer(signs, signs)
            for x, w in zip(*GAUSS, strict=True):
                if load is not None:
                    f[ends] += (
                        shapes((x + 1) / 2, l, phi)
                        * signs
                        * (axes @ load((x + 1) / 2))[across]
                        * w
                        * l
                        / 2
                    )
        for x, w in zip(*GAUSS, strict=True):
            if load is not None:
                f[[0, 6]] += (
                    np.array([(1 - x) / 2, (1 + x) / 2]) * (axes @ load((x + 1) / 2))[0] * w * l / 2
                )
        self.elements.append((a, b, np.kron(np.eye(4), axes), k, f))

    def push(self, node, force=(0, 0, 0), couple=(0, 0, 0)):
        self.loads[node] = self.loads.get(node, 0.0) + np.array([*force, *couple], float)

    def tie(self, parent, child, row):
        """The child's displacements (6,) along a row are the parent's; of the ground, None, they
        are nil. A number.
        """
        self.ties.append((parent, child, np.asarray(row, float)))
        return len(self.ties) - 1

    def solve(self):
        """Displacements (nodes, 6), and what ties do to the child, a number each."""
        n, m = 6 * len(self.places), len(self.ties)
        k, f = np.zeros((n + m, n + m)), np.zeros(n + m)
        for a, b, turn, stiffness, load in self.elements:
            at = [*range(6 * a, 6 * a + 6), *range(6 * b, 6 * b + 6)]
            k[np.ix_(at, at)] += turn.T @ stiffness @ turn
            f[at] += turn.T @ load
        for node, load in self.loads.items():
            f[6 * node : 6 * node + 6] += load
        for i, (parent, child, row) in enumerate(self.ties):
            for node, sign in ((child, 1), (parent, -1)):
                if node is not None:
                    k[n + i, 6 * node : 6 * node + 6] += sign * row
        k[:n, n:] = k[n:, :n].T
        # Rows of the unit of stiffness, so that the matrix is well scaled.
        size = np.abs(k[:n, :n]).max()
        k[n:, :n] *= size
        k[:n, n:] *= size
        found = np.linalg.solve(k, f)
        return found[:n].reshape(-1, 6), -size * found[n:]


def of_solution(solution, i, sections, loads=(), accelerations=None):
    """The frame of a mechanism at an instant, its drives locked: the reactions of joints on their
    children, in ground axes.

    ``sections`` are (properties, E, G, mass per length) by link; ``loads`` (link, x, force, couple)
    in ground axes; ``accelerations`` tells the acceleration of a link's place x.
    """
    told, frame, nodes = solution.description, Frame(), {}
    space = told.space
    gravity, bodies = np.array(told.gravity), told.bodies.items()
    places = {name: {0.0, body.length} for name, body in bodies if body.length is not None}
    for joint in told.joints.values():
        for end in (joint.parent, joint.child):
            if end.body in places:
                places[end.body].add(end.at[0])
    for link, x, *_ in loads:
        places[link].add(x)
    axes_of = {"ground": np.eye(3)}
    for link, xs in places.items():
        pose = solution.pose(link)
        if space:
            axes = pose.axes[i]
            base = np.array([pose.x[i], pose.y[i], pose.z[i]])
        else:
            c, s = np.cos(pose.angle[i]), np.sin(pose.angle[i])
            axes = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
            base = np.array([pose.x[i], pose.y[i], 0.0])
        axes_of[link] = axes
        p, e, g, line = sections[link]
        ordered = sorted(xs)
        for x in ordered:
            nodes[link, x] = frame.node(base + x * axes[0])
        for a, b in itertools.pairwise(ordered):

            def load(share, a=a, b=b, link=link, line=line):
                return line * (
                    gravity - (accelerations(link, a + (b - a) * share) if accelerations else 0.0)
                )

            frame.beam(nodes[link, a], nodes[link, b], axes, p, e, g, load)
    for link, x, force, couple in loads:
        frame.push(nodes[link, x], force, couple)
    if not space:
        for node in range(len(frame.places)):
            for k in (2, 3, 4):
                frame.tie(None, node, np.eye(6)[k])
    for name, body in bodies:
        if body.length is None:
            pose = solution.pose(name)
            node = nodes[name, 0.0] = frame.node(
                [pose.x[i], pose.y[i], pose.z[i] if space else 0.0]
            )
            frame.push(node, body.mass * gravity)
            for k in (3, 4, 5) if space else (2, 3, 4, 5):
                frame.tie(None, node, np.eye(6)[k])
    rows = {}
    for name, joint in told.joints.items():
        parent, child = (nodes.get((end.body, end.at[0])) for end in (joint.parent, joint.child))
        kind, driven = joint.kind, any(axis.coordinate in told.driven for axis in joint.axes)
        triad = np.array(joint.triad) @ axes_of[joint.parent.body]
        if kind == "prismatic":
            across = list(np.linalg.svd(triad[:1])[2][1:])
            moves, turns = across, list(triad)
            driving = [[*triad[0], 0, 0, 0]]
        else:
            moves = list(np.eye(3))
            turns = {"revolute": list(triad[1:]), "weld": list(triad), "spherical": []}[kind]
            driving = [[0, 0, 0, *triad[0]]]
        if not space:
            moves = [d for d in moves if abs(d[2]) < 0.5]
            turns = [d for d in turns if abs(d[2]) > 0.5]
        if not told.oriented(joint.child.body):
            turns = []
        own = [[*d, 0, 0, 0] for d in moves] + [[0, 0, 0, *d] for d in turns]
        rows[name] = [(frame.tie(parent, child, row), np.array(row, float)) for row in own]
        for row in driving if driven else ():
            frame.tie(parent, child, row)
    displacements, multipliers = frame.solve()
    reactions = {
        name: sum((multipliers[k] * row for k, row in ties), np.zeros(6))
        for name, ties in rows.items()
    }
    return reactions, {place: displacements[node] for place, node in nodes.items()}
