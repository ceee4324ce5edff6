"""Exercises of chapter 9, your own camera: residuals, error bars, judgement, the whole pipeline."""
