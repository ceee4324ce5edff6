"""Numbers as text: no more digits than are known."""

from math import floor, log10

_MOST = 9  # decimals, of deviations that are mere rounding


def decimals(std: float) -> int:
    """Count the decimals that show two digits of a standard deviation.

    Examples
    --------
    >>> decimals(0.4144), decimals(12.0)
    (2, 0)
    """
    return max(1 - floor(log10(std)), 0) if std > 0 else 2


def fixed(x: float, digits: int, sign: str = "-") -> str:
    """Spell x with so many decimals, zero as no negative number; ``sign="+"`` shows every sign.

    Examples
    --------
    >>> fixed(-0.0004, 2)
    '0.00'
    """
    return f"{round(x, digits) + 0.0:{sign}.{digits}f}"


def with_deviation(value: float, std: float) -> tuple[str, str]:
    """Spell a value and its standard deviation, both to two digits of the latter.

    What comes after them is noise.

    Examples
    --------
    >>> with_deviation(533.0912, 0.4144)
    ('533.09', '0.41')
    """
    digits = min(decimals(std), _MOST)
    return fixed(value, digits), fixed(std, digits)


def round_number(x: float) -> float:
    """Return the largest of 1, 2, 5, 10, 20, … and their tenths that is not above x > 0.

    Examples
    --------
    >>> round_number(49.0), round_number(0.5)
    (20.0, 0.5)
    """
    power = 10.0 ** floor(log10(x))
    return float(power * max(step for step in (1, 2, 5) if step * power <= x * (1 + 1e-12)))
