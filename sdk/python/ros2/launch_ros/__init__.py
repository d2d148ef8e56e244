"""Refused at its use: launch files."""

from rclpy import _stand_ins

_stand_ins.install(
    __name__,
    "name the programs of the system in the scenario, with their arguments",
    (
        "actions",
        "descriptions",
        "event_handlers",
        "events",
        "events.lifecycle",
        "parameter_descriptions",
        "parameters_type",
        "substitutions",
        "utilities",
    ),
)
