# SPDX-License-Identifier: Apache-2.0
"""One trace by the workers of Dask, and by the ranks of mpi4py: the bits of one process."""
import os
import pickle
import shutil
import subprocess
import sys
from pathlib import Path

import lucerna as lu
import pytest
from conftest import RAYS, SANITIZED

not_sanitized = pytest.mark.skipif(SANITIZED, reason="programs that are not ours start the processes")


def trace_range(scene, first, last):
    return os.getpid(), scene.trace(rays=(first, last))


def only_result(found):
    return found[1]


def merged(*parts):
    return lu.merge(parts)


@pytest.fixture(scope="module")
def client(tmp_path_factory):
    distributed = pytest.importorskip("distributed", reason="needs python3-distributed")
    import dask

    with dask.config.set({"distributed.worker.multiprocessing-method": "spawn"}), \
         distributed.LocalCluster(2, threads_per_worker=1, processes=True, host="127.0.0.1", dashboard_address=None,
                                  local_directory=str(tmp_path_factory.mktemp("dask"))) as cluster, \
         distributed.Client(cluster) as one:
        yield one


@not_sanitized
def test_dask_workers_make_the_bits_of_one_trace(client, lamp, traced):
    cuts = [0, RAYS // 7, RAYS // 3, RAYS // 2, RAYS]
    scene = client.scatter(lamp, broadcast=True)
    workers = list(client.scheduler_info()["workers"])
    jobs = [client.submit(trace_range, scene, first, last, workers=[workers[k % 2]], pure=False)
            for k, (first, last) in enumerate(zip(cuts, cuts[1:]))]
    found = client.gather(jobs)
    pids = {pid for pid, _ in found}
    assert len(pids) == 2 and os.getpid() not in pids
    assert lu.merge([result for _, result in found]) == traced
    # Added by a worker, which has half of the parts from the other one.
    results = [client.submit(only_result, job) for job in jobs]
    assert client.submit(merged, *results, workers=[workers[1]]).result() == traced


@not_sanitized
@pytest.mark.mpi
def test_ranks_of_mpi4py_make_the_bits_of_one_trace(lamp, traced, tmp_path):
    pytest.importorskip("mpi4py", reason="needs python3-mpi4py")
    mpiexec = shutil.which("mpiexec.openmpi") or shutil.which("mpiexec")
    if not mpiexec:
        pytest.skip("needs mpiexec (openmpi-bin)")
    (tmp_path / "scene.pickle").write_bytes(pickle.dumps(lamp))
    # More ranks than cores, also as root.
    allowed = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
               "OMPI_MCA_rmaps_base_oversubscribe": "1"}
    script = Path(__file__).with_name("mpi_ranks.py")
    done = subprocess.run([mpiexec, "-n", "3", sys.executable, script, str(RAYS)], cwd=tmp_path,
                          capture_output=True, text=True, check=False, timeout=600, env={**os.environ, **allowed})
    assert done.returncode == 0, done.stdout + done.stderr
    assert "3 ranks" in done.stdout
    assert pickle.loads((tmp_path / "result.pickle").read_bytes()) == traced
