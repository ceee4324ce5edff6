"""Speed and accuracy against the peers: ``python -m benchmarks.<name>``."""
