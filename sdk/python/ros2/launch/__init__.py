"""Refused at its use: launch files."""

from rclpy import _stand_ins

_stand_ins.install(
    __name__,
    "name the programs of the system in the scenario, with their arguments",
    (
        "action",
        "actions",
        "condition",
        "conditions",
        "event_handlers",
        "events",
        "events.lifecycle",
        "events.matchers",
        "events.process",
        "frontend",
        "launch_context",
        "launch_description",
        "launch_description_entity",
        "launch_description_source",
        "launch_description_sources",
        "some_actions_type",
        "some_substitutions_type",
        "substitution",
        "substitutions",
        "utilities",
    ),
)
