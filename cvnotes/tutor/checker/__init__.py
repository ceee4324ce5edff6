"""The tutor: tries an answer safely, judges it, and names the mistake."""
