"""Sensors: the messages, which come from the definitions, and clouds of points."""
