"""Exercises of chapter 9, your own camera: residuals, judgement, the whole pipeline."""
