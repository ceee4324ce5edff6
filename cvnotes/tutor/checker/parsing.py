"""Python's parser for several threads.

Until 3.12 all threads share the parser's count of its own depth, and it gives up ("recursion depth
mismatch") where one begins while another is at work.
"""

import ast
import threading

_ONE_AT_A_TIME = threading.Lock()


def parsed(source: str) -> ast.Module:
    """Parse a source; errors are those of `ast.parse`.

    Examples
    --------
    >>> len(parsed("a = 1; b = 2").body)
    2
    """
    with _ONE_AT_A_TIME:
        return ast.parse(source)


def names_set(tree: ast.AST) -> list[str]:
    """Return the names that are given a value in a piece of code, each once.

    Examples
    --------
    >>> names_set(parsed("b = a; c = b; b = c"))
    ['b', 'c']
    """
    names = (node for node in ast.walk(tree) if isinstance(node, ast.Name))
    return list(dict.fromkeys(node.id for node in names if isinstance(node.ctx, ast.Store)))
