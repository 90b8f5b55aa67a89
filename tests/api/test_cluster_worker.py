"""What runs on a worker of a cluster: it is sent all that it needs, and refuses what would come to
other numbers.
"""

import pickle
import shutil
import subprocess
import sys

import numpy as np
import pytest
from internals import Plan, Request, designs_of
from internals import dask_workers as cluster

from lagrange_casadi import load_case
from lagrange_casadi.errors import ClusterError

# Another process builds as users do, and gives numbers of the same code only.
pytestmark = pytest.mark.usefixtures("released")

ELSEWHERE = """
import pickle, sys
from lagrange_casadi.cluster import dask_workers
sent, task, told, p = pickle.loads(sys.stdin.buffer.read())
sys.stdout.buffer.write(pickle.dumps(dask_workers._evaluate(sent, task, told, p, 3)))
"""


def test_a_worker_needs_no_file_of_the_case(tmp_path):
    """What a worker is sent is whole: here another process, elsewhere, after the case and the
    module beside it are gone.
    """
    (tmp_path / "here").mkdir()
    (tmp_path / "here" / "beside_it.py").write_text("LENGTH = 0.5\n")
    (tmp_path / "here" / "case.py").write_text(
        "import casadi\nfrom beside_it import LENGTH\nfrom lagrange_casadi import Mechanism, Scene,"
        " beams, motion\ndef scene():\n    m = Mechanism('arm')\n    beam ="
        " beams.Beam(beams.rectangle(0.02, 0.01), beams.material('C45+QT').but(endurance=2e8))\n   "
        " arm = m.link('arm', length=m.parameter('l', LENGTH, 'm'), beam=beam)\n    m.revolute('O',"
        " m.ground, arm)\n    m.line_load('wind', arm, y=-500.0, between=(0.1, 0.35))\n    law ="
        " motion.expression(lambda t: casadi.fabs(t + 1.0) + 0.2 * casadi.sin(9.0 * t))\n    return"
        " Scene(m, {'O': law}, t=(0, 0.5, 17), wanted=['effort', 'safety:arm'])\n"
    )
    plan = Plan.of(
        load_case(tmp_path / "here").scene,
        designs_of({"l": [0.4, 0.5]}),
        Request(xi=(0.0, 1.0, 3)),
        "histories",
    )
    shutil.rmtree(tmp_path / "here")
    told, p = plan.harvest.signature, plan.block(0, 2)
    sent = pickle.dumps((plan.harvest.engine.program, plan.harvest.whole))
    away = {
        "cwd": tmp_path,
        "input": pickle.dumps((sent, plan.harvest.task, told, p)),
        "capture_output": True,
        "timeout": 60,
    }
    done = subprocess.run([sys.executable, "-c", ELSEWHERE], check=False, **away)
    assert done.returncode == 0, done.stderr.decode()
    assert pickle.loads(done.stdout) == plan.harvest.chunks(p, 3)


def asked(scene):
    """A plan of the paper's mechanism, what is sent of it, and what it is told by."""
    request = Request(t=(0.0, 0.08, 9), wanted=["effort"])
    plan = Plan.of(scene, designs_of({"l": [0.2, 0.3]}), request)
    told = plan.harvest.signature
    return plan, pickle.dumps((plan.harvest.engine.program, plan.harvest.whole)), told


def test_a_worker_that_would_give_other_numbers_is_refused(slider_crank):
    """What runs on a worker, here with what another version would have told it."""
    plan, sent, told = asked(slider_crank.scene)
    p = np.array([[0.1, 0.2, 0.1, 0.1, 0.1]])
    assert cluster._evaluate(sent, plan.harvest.task, told, p, 3) == plan.harvest.chunks(p, 3)
    other = told | {"versions": told["versions"] | {"casadi": "3.7.0"}}
    with pytest.raises(
        ClusterError,
        match=r"than this machine: versions casadi was 3\.7\.0 and is .* on the worker",
    ):
        cluster._evaluate(sent, plan.harvest.task, other, p, 3)


def test_what_fails_on_a_worker_is_one_line(slider_crank):
    plan, sent, told = asked(slider_crank.scene)
    with pytest.raises(
        ClusterError,
        match=r"a worker failed: designs: expected an array of shape \(n, 5\), got \(1, 4\)",
    ):
        cluster._evaluate(sent, plan.harvest.task, told, np.zeros((1, 4)), 1)
