"""Learning by doing: estimates held against the truth, and exercises that answer."""
