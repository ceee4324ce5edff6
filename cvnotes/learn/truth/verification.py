"""Estimate against truth: one table for all chapters, which raises when something is off."""

from collections.abc import Mapping

from cvnotes.base import CvnotesError, InputTypeError, number
from cvnotes.learn.truth.table import Row, Verification


class NotVerified(CvnotesError):
    """An estimate is farther from the truth than it should be; the message is the table."""


def verify(
    estimated: Mapping[str, float], truth: Mapping[str, float], *, std: Mapping[str, float]
) -> Verification:
    """Hold estimates against the truth, and raise if one is farther off than it should be.

    Parameters
    ----------
    estimated, truth : mapping of names to numbers
        The names in `estimated` are compared.
    std : mapping of names to numbers
        Predicted standard deviations: errors up to four of them hold.

    Returns
    -------
    Verification
        A table with what was found, what is true, and what error was to be expected.

    Raises
    ------
    NotVerified
        Something is off; the table is the message.

    Examples
    --------
    >>> verify({"u0": 325.02, "k1": -0.2}, {"u0": 325, "k1": -0.2}, std={"u0": 0.1, "k1": 0.01})
    verified: every estimate is as near to the truth as it should be
             estimate   truth   error  expected
    u0 (px)    325.02  325.00   +0.02     ± 0.1  ✓ holds
    k1         -0.200  -0.200  +0.000    ± 0.01  ✓ holds
    """
    for what, given in (("estimated", estimated), ("truth", truth), ("std", std)):
        if not isinstance(given, Mapping):
            raise InputTypeError(
                f"{what}: expected numbers by name, such as found.parameters, got "
                f"{type(given).__name__}"
            )
        for name in estimated:
            if name not in given:
                raise CvnotesError(f"{what}: expected {name!r} too, got only {', '.join(given)}")
    result = Verification(
        tuple(
            Row(name, *(number(given[name], name) for given in (estimated, truth, std)))
            for name in estimated
        )
    )
    if not result:
        raise NotVerified(repr(result))
    return result
