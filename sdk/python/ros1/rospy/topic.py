"""What publishers and subscribers have in common: a name, a class of messages, and one connection of the program with the topic."""

from __future__ import annotations

import genpy
from hrdsl.exchange import the_exchange
from rosgraph.names import is_legal_name
from rospy import core
from rospy.graph import graph
from rospy.names import resolve_name, resolve_name_without_node_name

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from hrdsl.exchange import Port

#: The connections of this program by the names of their topics.
publishers: dict[str, Any] = {}
subscribers: dict[str, Any] = {}


class Topic:
    """What both have in common."""

    impl: Any

    def __init__(self, name: str, data_class: Any) -> None:
        if not name or not isinstance(name, str):
            raise ValueError("topic name is not a non-empty string")
        if data_class is None:
            raise ValueError("topic parameter 'data_class' is not initialized")
        if not isinstance(data_class, type):
            raise ValueError("data_class [%s] is not a class" % data_class)
        if not issubclass(data_class, genpy.Message):
            raise ValueError("data_class [%s] is not a message data class" % data_class.__class__.__name__)
        if not is_legal_name(name):
            import warnings

            text = "'%s' is not a legal ROS graph resource name. This may cause problems with other ROS tools"
            warnings.warn(text % name, stacklevel=3)
        resolve = resolve_name if core.is_initialized() else resolve_name_without_node_name
        self.name: Any = resolve(name)
        self.resolved_name: Any = self.name
        self.data_class: Any = data_class
        self.type: Any = data_class._type
        self.md5sum: Any = data_class._md5sum

    def get_num_connections(self) -> int:
        """How many nodes are at the other end."""
        the_exchange().polled("connections")
        count: int = self.impl.get_num_connections()
        return count

    def unregister(self) -> None:
        """Leaves the topic."""
        impl, self.impl = self.impl, None
        if impl is not None:
            impl.release()
            self.resolved_name = self.type = self.md5sum = self.data_class = None


class TopicImpl:
    """The connection of a program with a topic, which is made when there is a node."""

    kind = ""
    others = ""

    def __init__(self, name: str, data_class: Any, table: dict[str, Any]) -> None:
        self.resolved_name = self.name = name
        self.data_class = data_class
        self.type = data_class._type
        self.ref_count = 0
        self.closed = False
        self.port: Port | None = None
        self._table = table
        table[name] = self
        core.when_initialized(self.connect)

    def connect(self) -> None:
        """There is a node."""
        if not self.closed and self.port is None:
            self.resolved_name = resolve_name(self.name)
            self.port = self.open()
            graph.forget()

    def open(self) -> Port:
        raise NotImplementedError

    def get_num_connections(self) -> int:
        return 0 if self.port is None else len(graph.programs(self.others, self.resolved_name))

    def has_connections(self) -> bool:
        return self.get_num_connections() > 0

    def release(self) -> None:
        """One of those that use it does so no more."""
        self.ref_count -= 1
        if self.ref_count == 0:
            self.close()
            self._table.pop(self.name, None)

    def close(self) -> None:
        self.closed = True
        port, self.port = self.port, None
        if port is not None and not the_exchange().link.stopped:
            port.close()
            graph.forget()
