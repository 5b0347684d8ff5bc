# SPDX-License-Identifier: Apache-2.0
"""Rays, and the frozen ray files (IES TM-25-13: a header, and seven floats a ray)."""
import dataclasses
import pathlib

import numpy as np

HEADER_BYTES, RAY_BYTES = 36288, 28


@dataclasses.dataclass(frozen=True)
class Rays:
    """Starts in mm and unit directions as rows, and the flux of each."""
    start: np.ndarray
    direction: np.ndarray
    flux: np.ndarray

    def __len__(self):
        return len(self.flux)

    def __getitem__(self, which):
        return Rays(self.start[which], self.direction[which], self.flux[which])

    @property
    def weight(self):
        """Shares of the whole flux."""
        return self.flux / self.flux.sum(dtype=float)


def read_tm25(file):
    """The rays of a file as `lucerna` writes it: position, direction, one flux. Other kinds are refused."""
    file = pathlib.Path(file)
    try:
        data = file.read_bytes()
    except OSError as e:
        raise ValueError(f"{file}: file: found {e.strerror}, expected a TM-25 file") from None
    if len(data) < HEADER_BYTES or data[:4] != b"TM25":
        raise ValueError(f"{file}: byte 0: found {len(data)} bytes that begin with {data[:4]!r}, expected a TM-25 file")
    count = int(np.frombuffer(data, "<u8", 1, 20)[0])
    flags = np.frombuffer(data, "<i4", 8, 256) == 1
    tables, items = np.frombuffer(data, "<i4", 2, 76)
    # Position, direction, radiant flux, polarisation, luminous flux, and others.
    if flags.tolist() not in ([True, True, watt, False, not watt, False, False, False] for watt in (True, False)) \
            or tables or items:
        raise ValueError(f"{file}: byte 256: found other columns, expected position, direction and one flux a ray")
    if count == 0 or HEADER_BYTES + RAY_BYTES * count > len(data):
        raise ValueError(f"{file}: byte 20: found {count} rays, expected one or more and no more than the file holds")
    columns = np.frombuffer(data, "<f4", 7 * count, len(data) - RAY_BYTES * count).reshape(count, 7)
    if not np.isfinite(columns).all() or (columns[:, 6] < 0.0).any() or not columns[:, 6].any():
        raise ValueError(f"{file}: rays: found a number that is not finite or no flux, expected finite rays with flux")
    return Rays(columns[:, :3], columns[:, 3:6], columns[:, 6])
