"""Pictures packed as PNG, quickly: what a slider moves, and the sheets of a calibration."""

import zlib
from struct import pack

import numpy as np
import numpy.typing as npt

from cvnotes.base.errors import ShapeError


def pack_png(picture: npt.NDArray[np.uint8], palette: npt.NDArray[np.uint8] | None = None) -> bytes:
    r"""Pack a picture of uint8 as PNG, in few milliseconds.

    It is (height, width, 3), or (height, width) with the colours (n, 3) that its bytes stand for.
    Each row is stored as its difference from the row above (filter 2, "up"), which turns most of
    a drawing into zeros, and compressed at level 1: in less than half of the time that Pillow takes
    at the same level, which tries every filter on every row. With a palette, runs of one byte are
    all that is looked for: that is quicker, and no larger.

    References
    ----------
    .. [1] ISO/IEC 15948, Portable Network Graphics.

    Examples
    --------
    >>> pack_png(np.zeros((2, 3, 3), np.uint8))[:8]
    b'\x89PNG\r\n\x1a\n'
    """
    per_pixel = (3,) if palette is None else ()
    if picture.ndim < 2 or picture.shape[2:] != per_pixel or picture.dtype != np.uint8:
        expected = "(height, width" + ", 3" * len(per_pixel) + ")"
        raise ShapeError(f"picture: expected uint8 {expected}, got {picture.shape}")
    height, width = picture.shape[:2]
    flat = picture.reshape(height, -1)
    rows = np.empty((height, 1 + flat.shape[1]), np.uint8)
    rows[:, 0] = 2
    rows[0, 1:] = flat[0]
    np.subtract(flat[1:], flat[:-1], out=rows[1:, 1:])
    header = pack(">IIBBBBB", width, height, 8, 2 if palette is None else 3, 0, 0, 0)
    strategy = zlib.Z_DEFAULT_STRATEGY if palette is None else zlib.Z_RLE
    packer = zlib.compressobj(1, strategy=strategy)
    packed = packer.compress(rows.data) + packer.flush()
    chunks = [(b"IHDR", header), (b"IDAT", packed), (b"IEND", b"")]
    if palette is not None:
        chunks.insert(1, (b"PLTE", palette.tobytes()))
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        pack(">I", len(data)) + kind + data + pack(">I", zlib.crc32(kind + data))
        for kind, data in chunks
    )
