"""Asks another node about its parameters, by the services that it has for that."""

from __future__ import annotations

import time

from rclpy.parameter import Parameter, parameter_dict_from_yaml_file
from rclpy.qos import qos_profile_services_default

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any, Callable, Sequence

    from rclpy.client import Client
    from rclpy.task import Future

    Callback = Callable[[Future], Any] | None


class AsyncParameterClient:
    """Gets and sets parameters of a node, whose name may be relative. What it returns is done when the node has answered,
    with the response of the service; a callback gets that future then."""

    def __init__(
        self, node: Any, remote_node_name: str, qos_profile: Any = qos_profile_services_default, callback_group: Any = None
    ) -> None:
        import rcl_interfaces.srv as services

        def client(kind: Any, name: str) -> Client:
            full = "%s/%s" % (remote_node_name, name)
            made: Client = node.create_client(kind, full, qos_profile=qos_profile, callback_group=callback_group)
            return made

        self.remote_node_name = remote_node_name
        self.node = node
        self._get = client(services.GetParameters, "get_parameters")
        self._set = client(services.SetParameters, "set_parameters")
        self._set_atomically = client(services.SetParametersAtomically, "set_parameters_atomically")
        self._types = client(services.GetParameterTypes, "get_parameter_types")
        self._describe = client(services.DescribeParameters, "describe_parameters")
        self._list = client(services.ListParameters, "list_parameters")

    def _clients(self) -> list[Client]:
        return [self._list, self._set, self._set_atomically, self._get, self._types, self._describe]

    def services_are_ready(self) -> bool:
        """Whether the node has all the services."""
        return all(client.service_is_ready() for client in self._clients())

    def wait_for_services(self, timeout_sec: float | None = None) -> bool:
        """Waits until it has, or until the timeout: whether it has."""
        end = None if timeout_sec is None else time.monotonic() + timeout_sec
        return all(
            client.wait_for_service(None if end is None else max(0.0, end - time.monotonic())) for client in self._clients()
        )

    def list_parameters(
        self, prefixes: Sequence[str] | None = None, depth: int | None = None, callback: Callback = None
    ) -> Future:
        """The names of its parameters, with these beginnings if there are some, and so many parts at most."""
        return _asked(self._list, callback, prefixes=list(prefixes or ()), depth=depth or 0)

    def get_parameters(self, names: Sequence[str], callback: Callback = None) -> Future:
        """The values of these."""
        return _asked(self._get, callback, names=list(names))

    def get_parameter_types(self, names: Sequence[str], callback: Callback = None) -> Future:
        """The types of these."""
        return _asked(self._types, callback, names=list(names))

    def describe_parameters(self, names: Sequence[str], callback: Callback = None) -> Future:
        """The descriptors of these."""
        return _asked(self._describe, callback, names=list(names))

    def set_parameters(self, parameters: Sequence[Any], callback: Callback = None) -> Future:
        """Sets these, one after the other; given as `Parameter`, or as messages."""
        return _asked(self._set, callback, parameters=_messages(parameters))

    def set_parameters_atomically(self, parameters: Sequence[Any], callback: Callback = None) -> Future:
        """Sets all of these, or none."""
        return _asked(self._set_atomically, callback, parameters=_messages(parameters))

    def delete_parameters(self, names: Sequence[str], callback: Callback = None) -> Future:
        """Leaves these without a value."""
        return self.set_parameters([Parameter(name, Parameter.Type.NOT_SET) for name in names], callback)

    def load_parameter_file(self, parameter_file: str, use_wildcard: bool = False, callback: Callback = None) -> Future:
        """Sets what a file of parameters has for this node, and, if asked, for all nodes."""
        return self.set_parameters(self._of_file(parameter_file, use_wildcard), callback)

    def load_parameter_file_atomically(
        self, parameter_file: str, use_wildcard: bool = False, callback: Callback = None
    ) -> Future:
        """The same, all or nothing."""
        return self.set_parameters_atomically(self._of_file(parameter_file, use_wildcard), callback)

    def _of_file(self, path: str, use_wildcard: bool) -> list[Any]:
        return list(parameter_dict_from_yaml_file(path, use_wildcard, [self.remote_node_name]).values())


def _asked(client: Client, callback: Callback, **fields: Any) -> Future:
    future = client.call_async(client.srv_type.Request(**fields))
    if callback is not None:
        future.add_done_callback(callback)
    return future


def _messages(parameters: Sequence[Any]) -> list[Any]:
    return [each.to_parameter_msg() if isinstance(each, Parameter) else each for each in parameters]
