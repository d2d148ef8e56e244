"""The services by which other nodes, and `ros2 param`, reach a node's parameters."""

from __future__ import annotations

from weakref import ref

from hrdsl.errors import ProtocolError

from rclpy.exceptions import ParameterNotDeclaredException, ParameterUninitializedException
from rclpy.parameter import Parameter
from rclpy.qos import qos_profile_parameters

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any

_SERVICES = {
    "describe_parameters": "DescribeParameters",
    "get_parameters": "GetParameters",
    "get_parameter_types": "GetParameterTypes",
    "list_parameters": "ListParameters",
    "set_parameters": "SetParameters",
    "set_parameters_atomically": "SetParametersAtomically",
}


class _Kind:
    """A type of service whose classes are made when a request comes, which is rare."""

    _kind_ = "Service"

    def __init__(self, name: str) -> None:
        self.__name__ = name
        self._definition_ = {"name": "rcl_interfaces/srv/%s" % name}

    def __getattr__(self, name: str) -> Any:
        import rcl_interfaces.srv as services

        return getattr(getattr(services, self.__name__), name)


class ParameterService:
    """The six services of a node."""

    def __init__(self, node: Any) -> None:
        self._node = ref(node)
        for name, kind in _SERVICES.items():
            callback = getattr(self, "_" + name)
            full = "%s/%s" % (node.get_name(), name)
            try:
                node.create_service(_Kind(kind), full, callback, qos_profile=qos_profile_parameters)
            except ProtocolError:  # another node has the same name, which is allowed
                return

    def _describe_parameters(self, request: Any, response: Any) -> Any:
        try:
            response.descriptors = self._the_node().describe_parameters(request.names)
        except ParameterNotDeclaredException:
            pass
        return response

    def _get_parameters(self, request: Any, response: Any) -> Any:
        node = self._the_node()
        try:
            response.values = [node.get_parameter(name).get_parameter_value() for name in request.names]
        except (ParameterNotDeclaredException, ParameterUninitializedException):
            pass
        return response

    def _get_parameter_types(self, request: Any, response: Any) -> Any:
        node = self._the_node()
        try:
            response.types = [getattr(kind, "value", kind) for kind in map(node.get_parameter_type, request.names)]
        except ParameterNotDeclaredException:
            pass
        return response

    def _list_parameters(self, request: Any, response: Any) -> Any:
        response.result = self._the_node().list_parameters(request.prefixes, request.depth)
        return response

    def _set_parameters(self, request: Any, response: Any) -> Any:
        response.results = [self._set([each]) for each in request.parameters]
        return response

    def _set_parameters_atomically(self, request: Any, response: Any) -> Any:
        response.result = self._set(request.parameters)
        return response

    def _set(self, parameters: Any) -> Any:
        from rcl_interfaces.msg import SetParametersResult

        try:
            return self._the_node().set_parameters_atomically(
                [Parameter.from_parameter_msg(each) for each in parameters]
            )
        except ParameterNotDeclaredException as error:
            return SetParametersResult(successful=False, reason=str(error))

    def _the_node(self) -> Any:
        node = self._node()
        if node is None:
            raise ReferenceError("Expected valid node weak reference")
        return node
