"""Run every benchmark, one after the other: ``python -m benchmarks``."""

from importlib import import_module
from pkgutil import iter_modules

import benchmarks


def main() -> None:
    for module in iter_modules(benchmarks.__path__):
        run = getattr(import_module(f"benchmarks.{module.name}"), "main", None)
        if run is not None and module.name != "__main__":
            print(f"\n== {module.name} ==\n", flush=True)
            run()


if __name__ == "__main__":
    main()
