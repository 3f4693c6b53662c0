"""Trials of a simulated iCub at a table: scene, physical action, tutor's sentence, MCAP log."""
