"""Numbers that several modules need."""

S_TO_NS = 1000 * 1000 * 1000
