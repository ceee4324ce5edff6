"""Run every benchmark, one after the other: ``python -m benchmarks``, or those that are named."""

import argparse
import sys
from importlib import import_module
from pkgutil import iter_modules

import benchmarks

NAMES = [module.name for module in iter_modules(benchmarks.__path__)]
# What several benchmarks share.
NO_BENCHMARKS = {"__main__", "peers", "screen", "turns"}


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    known = sorted(set(NAMES) - NO_BENCHMARKS)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"{', '.join(known)} (all)")
    names = parser.parse_args(arguments).names or known
    for name in names:
        if name not in known:
            parser.error(f"there is no benchmark {name!r}; there are {', '.join(known)}")
    for name in names:
        print(f"\n== {name} ==\n", flush=True)
        sys.argv[1:] = []
        import_module(f"benchmarks.{name}").main()


if __name__ == "__main__":
    main()
