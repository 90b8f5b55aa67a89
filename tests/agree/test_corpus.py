"""The frozen corpus notices a change of one part in 1e9, and reports what is allowed in vain."""

import corpus
import pytest

pytestmark = pytest.mark.quick

TEXT = """from lagrange_casadi import Mechanism, Scene, motion
m = Mechanism("pendulum")
rod = m.link("rod", length=0.3, mass=1.0)
m.revolute("O", m.ground, rod)
m.force("side", rod.tip, x=2.0)
scene = Scene(m, {"O": motion.harmonic(0.1, 0.5, 1.0)}, t=(0.0, 1.0, 9))
"""


@pytest.fixture(scope="module")
def was(tmp_path_factory):
    """The mechanism in a file."""
    folder = tmp_path_factory.mktemp("frozen")
    corpus.make("pendulum", TEXT, folder, False, "a commit")
    return folder / "pendulum.npz"


def test_what_is_not_changed_is_as_it_was(was):
    text, every, found = corpus.read(was)
    assert (text, every, [*found]) == (TEXT, False, ["evaluate", "errors", "peaks"])
    assert found["evaluate"].values["section:rod:shear"].shape == (9, 5)
    assert not corpus.check(was)


@pytest.mark.parametrize(
    ("old", "new", "where"),
    [
        ("mass=1.0", "mass=1.000000001", "evaluate/effort:O"),
        ("x=2.0", "x=2.000000002", "peaks/section:rod:axial"),
        ("0.1, 0.5", "0.1, 0.5000000005", "evaluate/pose:rod:angle"),
        ('"O"', '"P"', "evaluate/effort:O"),
        ("0, 9)", "0, 8)", "evaluate/effort:O"),
        ("length=0.3", "length=-0.3", "evaluate/status"),
    ],
)
def test_one_part_in_a_billion_is_noticed(was, old, new, where):
    text, every, found = corpus.read(was)
    assert old in text
    assert where in dict(corpus.differences(found, corpus.results(text.replace(old, new), every)))


def test_a_difference_is_allowed_for_a_reason():
    allowed = corpus.allowances("# why\n\none/*/effort:O a law of another sign\ntwo/* gone\n")
    found = [("one/peaks/effort:O", "off by 1"), ("one/peaks/effort:P", "off by 2")]
    assert corpus.judged(found, allowed) == (
        ["one/peaks/effort:P: off by 2"],
        {"one/*/effort:O": 1},
    )
    with pytest.raises(ValueError, match=r"one/\* has no reason"):
        corpus.allowances("one/*\n")


def test_what_is_no_number_stays_none():
    def record(*values, within=1.0):
        return {"way": corpus.Record("ok", {"x": corpus.np.array(values)}, {"x": within})}

    nan, inf = float("nan"), float("inf")
    for was, now, is_same in (
        (record(1.0, nan), record(1.5, nan), True),
        (record(1.0, nan), record(2.5, nan), False),
        (record(1.0, nan), record(1.0, inf), False),
        (record(1.0, nan), record(nan, nan), False),
        (record(1.0), record(1.0, 1.0), False),
        (record(1.0, within=nan), record(1.0), False),
    ):
        assert bool([*corpus.differences(was, now)]) != is_same
