"""Refused: launch files."""

raise NotImplementedError(
    "launch is not supported by hrdsl's rclpy: "
    "name the programs of the system in the scenario, with their arguments"
)
