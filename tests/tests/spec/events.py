"""Which events patterns mean, as `spec/vocabulary.md` defines it."""

from agent_values import alike, value_of


def fits(patterns, event, args):
    """Whether one of the patterns is of this event with these arguments."""
    same = lambda p, v: p == "any" or alike(value_of(p["is"]), value_of(v))
    return any(p["event"] == event and all(map(same, p["args"], args)) for p in patterns)
