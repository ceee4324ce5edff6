"""Flat figures: each function draws on axes and gives them back."""
