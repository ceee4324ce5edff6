"""Exercises of chapter 10, two pictures: cameras side by side, and the depth that both see."""
