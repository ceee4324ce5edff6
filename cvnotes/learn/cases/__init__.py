"""Random cameras and small pictures for the exercises."""
