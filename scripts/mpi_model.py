#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How long `lucerna-mpi trace` will take on many ranks, by a model whose parameters scripts/mpi_scaling.sh measures; a Markdown table.

time = start and files + rays / (ranks * speed) + one chunk + levels * (latency + bytes / network + bytes / adding)
       + checkpoints * parts / disk
with levels = ceil(log2 ranks) of the reduction, bytes of all sums (two lanes beyond 2^34 rays), a chunk as distributed_trace.cpp takes it,
and a checkpoint every 300 s. The chunk is the worst case: the last one begins when all others have ended.
"""
import argparse
import math


def chunk_rays(rays, ranks):
    """As `chosen_chunk` of src/lucerna/distributed/distributed_trace.cpp."""
    return min(max(rays // (16 * ranks), 2**20), 2**24)


def seconds(rays, ranks, p):
    """The terms of the model, in its order."""
    lanes = 2 if rays > 2**34 else 1
    size = lanes * p.sums_mb * 1e6
    speed = 1e6 * p.speed
    tracing = rays / (ranks * speed)
    last = chunk_rays(rays, ranks) / speed if ranks > 1 else 0.0
    levels = math.ceil(math.log2(ranks))
    reduction = levels * (1e-6 * p.latency_us + size / (1e9 * p.network_gb) + size / (1e9 * p.adding_gb))
    checkpoints = math.floor(tracing / 300) * ranks * p.part_mb * 1e6 / (1e9 * p.disk_gb)
    return p.fixed, tracing, last, reduction, checkpoints


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--speed", type=float, required=True, help="M rays per second of one core")
    parser.add_argument("--fixed", type=float, required=True, help="seconds of start, figures and files")
    parser.add_argument("--sums-mb", type=float, default=1.67, help="MB of the sums in one lane")
    parser.add_argument("--part-mb", type=float, default=0.3, help="MB of a rank's part on disk")
    parser.add_argument("--latency-us", type=float, default=50, help="of a message of the network; assumed")
    parser.add_argument("--network-gb", type=float, default=1.0, help="GB/s of one link; assumed")
    parser.add_argument("--adding-gb", type=float, default=2.0, help="GB/s of adding sums; assumed")
    parser.add_argument("--disk-gb", type=float, default=0.5, help="GB/s that all ranks write together; assumed")
    p = parser.parse_args()
    print("| rays | ranks | s | tracing | last chunk | reduction | checkpoints | efficiency |")
    print("|---|---|---|---|---|---|---|---|")
    for rays in (10**9, 10**10, 10**12):
        for ranks in (1, 2, 8, 64, 256, 1024):
            fixed, tracing, last, reduction, checkpoints = seconds(rays, ranks, p)
            total = fixed + tracing + last + reduction + checkpoints
            print(f"| 10^{round(math.log10(rays))} | {ranks} | {total:.4g} | {tracing:.4g} | {last:.3g} | {reduction:.2g} "
                  f"| {checkpoints:.2g} | {100 * tracing / total:.0f} % |")


if __name__ == "__main__":
    main()
