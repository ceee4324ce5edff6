"""Long arrays taken in parts, so that what is computed of each part stays in the cache."""

from collections.abc import Iterator


def chunks(n: int, size: int) -> Iterator[slice]:
    """Cut n rows into slices of at most `size`.

    Examples
    --------
    >>> list(chunks(5, 2))
    [slice(0, 2, None), slice(2, 4, None), slice(4, 5, None)]
    """
    return (slice(first, min(first + size, n)) for first in range(0, n, size))
