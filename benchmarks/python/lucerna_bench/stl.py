# SPDX-License-Identifier: Apache-2.0
"""Height fields as triangles, in binary STL files."""
import pathlib

import numpy as np

# A rim's corners have the normals of the facets within: a narrow last ring makes them those of the rim.
RIM_MM = 0.01


def disk_triangles(height, radius_mm, rings=120, sectors=240):
    """Triangles of a height field z = height(x, y) over a disk, as rows of three corners whose order gives normals to
    +z: the first ring is a fan about the centre, the last one is narrow."""
    r = np.append(np.linspace(0.0, radius_mm - RIM_MM, rings)[1:], radius_mm)
    turn = 2.0 * np.pi * np.arange(sectors) / sectors
    x, y = np.outer(r, np.cos(turn)), np.outer(r, np.sin(turn))
    corners = np.stack([x, y, height(x, y)], axis=-1)
    middle = np.broadcast_to([0.0, 0.0, height(np.zeros(1), np.zeros(1))[0]], (sectors, 3))
    after = np.roll(corners, -1, axis=1)
    fan = np.stack([middle, corners[0], after[0]], axis=1)
    first = np.stack([corners[:-1], corners[1:], after[1:]], axis=2).reshape(-1, 3, 3)
    second = np.stack([corners[:-1], after[1:], after[:-1]], axis=2).reshape(-1, 3, 3)
    return np.concatenate([fan, first, second])


def write_stl(file, triangles):
    """A binary STL file; its stored normals are 0, so that the order of corners counts."""
    facets = np.zeros(len(triangles), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    facets["corners"] = triangles
    pathlib.Path(file).write_bytes(bytes(80) + np.uint32(len(triangles)).tobytes() + facets.tobytes())
