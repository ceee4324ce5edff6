"""Pictures packed as PNG, quickly: what a slider moves."""

import zlib
from struct import pack

import numpy as np
import numpy.typing as npt

from cvnotes.base.errors import ShapeError


def pack_png(picture: npt.NDArray[np.uint8]) -> bytes:
    r"""Pack a picture (height, width, 3) of uint8 as PNG, in few milliseconds.

    Each row is stored as its difference from the row above (filter 2, "up"), which turns most of
    a drawing into zeros, and compressed at level 1: in less than half of the time that Pillow takes
    at the same level, which tries every filter on every row.

    References
    ----------
    .. [1] ISO/IEC 15948, Portable Network Graphics.

    Examples
    --------
    >>> pack_png(np.zeros((2, 3, 3), np.uint8))[:8]
    b'\x89PNG\r\n\x1a\n'
    """
    if picture.ndim != 3 or picture.shape[2] != 3 or picture.dtype != np.uint8:
        raise ShapeError(f"picture: expected uint8 (height, width, 3), got {picture.shape}")
    height, width = picture.shape[:2]
    flat = picture.reshape(height, -1)
    rows = np.empty((height, 1 + flat.shape[1]), np.uint8)
    rows[:, 0] = 2
    rows[0, 1:] = flat[0]
    np.subtract(flat[1:], flat[:-1], out=rows[1:, 1:])
    header = pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    chunks = ((b"IHDR", header), (b"IDAT", zlib.compress(rows.data, 1)), (b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        pack(">I", len(data)) + kind + data + pack(">I", zlib.crc32(kind + data))
        for kind, data in chunks
    )
