"""The messages that rclpy cannot do without."""

try:
    from rcl_interfaces.msg import ParameterDescriptor as ParameterDescriptor
    from rcl_interfaces.msg import SetParametersResult as SetParametersResult
except ModuleNotFoundError:
    raise ImportError(
        "rclpy needs the definitions of rcl_interfaces, which this program was not given: it is not run by hrdsl for ROS 2, "
        "or the scenario's workspace has another package of that name"
    ) from None
