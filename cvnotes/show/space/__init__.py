"""Figures in three dimensions: stills on paper, and scenes to turn."""
