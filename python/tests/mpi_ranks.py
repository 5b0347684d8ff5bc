# SPDX-License-Identifier: Apache-2.0
"""mpirun -n N python3 mpi_ranks.py RAYS: all ranks trace scene.pickle, each a range; rank 0 writes result.pickle."""
import pickle
import sys
from pathlib import Path

import lucerna as lu
from mpi4py import MPI


def main(rays):
    world = MPI.COMM_WORLD
    rank, size = world.Get_rank(), world.Get_size()
    scene = world.bcast(pickle.loads(Path("scene.pickle").read_bytes()) if rank == 0 else None)
    part = scene.trace(rays=(rank * rays // size, (rank + 1) * rays // size))
    parts = world.gather(part)
    if rank == 0:
        Path("result.pickle").write_bytes(pickle.dumps(lu.merge(parts)))
        print(size, "ranks")


if __name__ == "__main__":
    main(int(sys.argv[1]))
