"""Nodes."""

from __future__ import annotations

from weakref import ref

from rclpy import _arguments, _names, _world
from rclpy import executors as _executors  # which programs find as `rclpy.executors`
from rclpy._node_entities import NodeEntities
from rclpy._node_graph import NodeGraph, nodes
from rclpy._node_parameters import NodeParameters
from rclpy._rclpy_pybind11 import NodeNameNonExistentError as NodeNameNonExistentError
from rclpy.callback_groups import CallbackGroup, MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.client import Client
from rclpy.clock import Clock, ROSClock
from rclpy.constants import S_TO_NS
from rclpy.exceptions import InvalidTopicNameException, NotInitializedException
from rclpy.guard_condition import GuardCondition
from rclpy.logging import get_logger
from rclpy.parameter import Parameter
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile, qos_profile_services_default
from rclpy.service import Service
from rclpy.subscription import Subscription
from rclpy.timer import Rate, Timer
from rclpy.type_support import check_is_valid_msg_type, check_is_valid_srv_type
from rclpy.utilities import get_default_context
from rclpy.validate_full_topic_name import validate_full_topic_name
from rclpy.validate_namespace import validate_namespace
from rclpy.validate_node_name import validate_node_name
from rclpy.validate_topic_name import validate_topic_name

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any, Callable

    from rclpy.context import Context
    from rclpy.executors import Executor
    from rclpy.impl.rcutils_logger import RcutilsLogger


class Node(NodeEntities, NodeParameters, NodeGraph):
    """A node: what has publishers, subscriptions, timers, services, clients and parameters."""

    PARAM_REL_TOL = 1e-6

    def __init__(
        self,
        node_name: str,
        *,
        context: Context | None = None,
        cli_args: list[str] | None = None,
        namespace: str | None = None,
        use_global_arguments: bool = True,
        enable_rosout: Any = True,
        start_parameter_services: bool = True,
        parameter_overrides: list[Parameter] | None = None,
        allow_undeclared_parameters: bool = False,
        automatically_declare_parameters_from_overrides: bool = False,
        enable_logger_service: bool = False,
    ) -> None:
        self._context = get_default_context() if context is None else context
        self._init_entities_()
        self._default_callback_group = MutuallyExclusiveCallbackGroup()
        self._rate_group = ReentrantCallbackGroup()
        self._executor_: Callable[[], Executor | None] | None = None
        self._is_destroyed_ = False
        if not self._context.is_open():
            raise NotInitializedException("cannot create node")
        self._sources_ = [_arguments.Arguments(["--ros-args", *cli_args])] if cli_args else []
        if use_global_arguments:
            self._sources_.append(self._context.arguments)
        self._set_names_(node_name, namespace or "")
        name = self.get_fully_qualified_name()
        self._logger = get_logger(name[1:].replace("/", "."))
        overrides = _arguments.parameters_of(self._sources_[::-1], name)
        self._init_parameters_(overrides, allow_undeclared_parameters)
        self._parameter_overrides.update({each.name: each for each in parameter_overrides or ()})
        self._parameter_events_: Publisher | None = None
        self._clock = ROSClock()
        if automatically_declare_parameters_from_overrides:
            from rcl_interfaces.msg import ParameterDescriptor

            given = [(each.name, each.value, ParameterDescriptor()) for each in self._parameter_overrides.values()]
            self.declare_parameters("", given, ignore_override=True)
        self._attach_time_()
        nodes.append(self)
        if start_parameter_services:
            from rclpy.parameter_service import ParameterService

            self._parameter_service = ParameterService(self)

    def _set_names_(self, name: str, namespace: str) -> None:
        if _names.fault_of_node_name(name) is not None:
            validate_node_name(name)
        namespace = namespace if namespace.startswith("/") else "/" + namespace
        validate_namespace(namespace)
        # Rules for the namespace look at the name that the program has written.
        self._namespace_ = _arguments.remapped(self._sources_, "ns", namespace, name)
        self._name_ = _arguments.remapped(self._sources_, "node", name, name)

    def _attach_time_(self) -> None:
        if not self.has_parameter("use_sim_time"):
            self.declare_parameter("use_sim_time", False)
        value = self.get_parameter("use_sim_time")
        if value.type_ is Parameter.Type.BOOL:
            self._clock._set_ros_time_is_active(value.value)
        else:
            text = "Invalid type for parameter 'use_sim_time' %s should be bool"
            self._logger.error(text % (value.type_,))
        self._post_set_parameters_callbacks.append(self._follow_time_)

    def _follow_time_(self, parameters: list[Parameter]) -> None:
        for parameter in parameters:
            if parameter.name == "use_sim_time" and parameter.type_ is Parameter.Type.BOOL:
                self._clock._set_ros_time_is_active(parameter.value)

    # ── what it belongs to ──

    @property
    def executor(self) -> Executor | None:
        """The executor that runs its callbacks."""
        return None if self._executor_ is None else self._executor_()

    @executor.setter
    def executor(self, new_executor: Executor | None) -> None:
        current = self.executor
        if current is new_executor:
            return
        if current is not None:
            current.remove_node(self)
        if new_executor is None:
            self._executor_ = None
        else:
            new_executor.add_node(self)
            self._executor_ = ref(new_executor)

    def _wake_executor(self) -> None:
        executor = None if self._executor_ is None else self._executor_()
        if executor is not None:
            executor._bell.ring()

    @property
    def context(self) -> Context:
        """The context that ends it."""
        return self._context

    @property
    def default_callback_group(self) -> CallbackGroup:
        """The group of what is made without one."""
        return self._default_callback_group

    @property
    def handle(self) -> Any:
        """Refused: there is no C library below."""
        _world.unsupported("Node.handle", "use the methods of the node")

    def get_name(self) -> str:
        """Its name."""
        return self._name_

    def get_namespace(self) -> str:
        """Its namespace."""
        return self._namespace_

    def get_fully_qualified_name(self) -> str:
        """Both."""
        return self._namespace_.rstrip("/") + "/" + self._name_

    def get_clock(self) -> Clock:
        """Its clock."""
        return self._clock

    def get_logger(self) -> RcutilsLogger:
        """Its logger."""
        return self._logger

    # ── names ──

    def resolve_topic_name(self, topic: str, *, only_expand: bool = False) -> str:
        """The full name of a topic, remapped."""
        return self._resolve_(topic, "topic", only_expand)

    def resolve_service_name(self, service: str, *, only_expand: bool = False) -> str:
        """The full name of a service, remapped."""
        return self._resolve_(service, "service", only_expand)

    def _resolve_(self, name: str, kind: str, only_expand: bool = False) -> str:
        is_service = kind == "service"
        validate_topic_name(name, is_service=is_service)

        def expand(each: str) -> str:
            return _names.expanded(each, self._name_, self._namespace_)

        try:
            full = expand(name)
        except ValueError as error:
            raise InvalidTopicNameException(name, str(error), 0) from None
        if not only_expand:
            full = _arguments.remapped(self._sources_, kind, full, self._name_, expand)
        validate_full_topic_name(full, is_service=is_service)
        return full

    def _profile_(self, given: Any) -> QoSProfile:
        if isinstance(given, QoSProfile):
            return given
        if isinstance(given, int):
            if given < 0:
                raise ValueError("history depth must be greater than or equal to zero")
            return QoSProfile(depth=given)
        raise TypeError("Expected QoSProfile or int, but received %r" % type(given))

    # ── making ──

    def _added_(self, entities: list[Any], entity: Any, callback_group: CallbackGroup | None) -> Any:
        if callback_group is not None:
            callback_group.add_entity(entity)
        entities.append(entity)
        self._wake_executor()
        return entity

    def create_publisher(
        self,
        msg_type: Any,
        topic: str,
        qos_profile: QoSProfile | int,
        *,
        callback_group: CallbackGroup | None = None,
        event_callbacks: Any = None,
        qos_overriding_options: Any = None,
        publisher_class: type[Publisher] = Publisher,
    ) -> Publisher:
        """A new publisher."""
        profile = self._profile_(qos_profile)
        name = self.resolve_topic_name(topic)
        check_is_valid_msg_type(msg_type)
        publisher = publisher_class(self, msg_type, topic, name, profile, event_callbacks)
        return self._added_(self._publishers, publisher, None)  # type: ignore[no-any-return]

    def create_subscription(
        self,
        msg_type: Any,
        topic: str,
        callback: Callable[..., Any],
        qos_profile: QoSProfile | int,
        *,
        callback_group: CallbackGroup | None = None,
        event_callbacks: Any = None,
        qos_overriding_options: Any = None,
        raw: bool = False,
        content_filter_options: Any = None,
    ) -> Subscription:
        """A new subscription."""
        if raw:
            _world.unsupported("a raw subscription", "messages are no bytes here; subscribe without `raw`")
        profile = self._profile_(qos_profile)
        group = callback_group or self._default_callback_group
        name = self.resolve_topic_name(topic)
        check_is_valid_msg_type(msg_type)
        subscription = Subscription(self, msg_type, topic, name, callback, group, profile, event_callbacks)
        return self._added_(self._subscriptions, subscription, group)  # type: ignore[no-any-return]

    def create_client(
        self,
        srv_type: Any,
        srv_name: str,
        *,
        qos_profile: QoSProfile = qos_profile_services_default,
        callback_group: CallbackGroup | None = None,
    ) -> Client:
        """A new client of a service."""
        group = callback_group or self._default_callback_group
        check_is_valid_srv_type(srv_type)
        client = Client(self, srv_type, srv_name, self.resolve_service_name(srv_name), qos_profile, group)
        return self._added_(self._clients, client, group)  # type: ignore[no-any-return]

    def create_service(
        self,
        srv_type: Any,
        srv_name: str,
        callback: Callable[..., Any],
        *,
        qos_profile: QoSProfile = qos_profile_services_default,
        callback_group: CallbackGroup | None = None,
    ) -> Service:
        """A new service."""
        group = callback_group or self._default_callback_group
        check_is_valid_srv_type(srv_type)
        name = self.resolve_service_name(srv_name)
        service = Service(self, srv_type, srv_name, name, callback, group, qos_profile)
        return self._added_(self._services, service, group)  # type: ignore[no-any-return]

    def create_timer(
        self,
        timer_period_sec: float,
        callback: Any,
        callback_group: CallbackGroup | None = None,
        clock: Clock | None = None,
        autostart: bool = True,
    ) -> Timer:
        """A new timer."""
        period = int(float(timer_period_sec) * S_TO_NS)
        group = callback_group or self._default_callback_group
        timer = Timer(callback, group, period, clock or self._clock, context=self._context, autostart=autostart)
        timer._wake = self._wake_executor
        return self._added_(self._timers, timer, group)  # type: ignore[no-any-return]

    def create_guard_condition(
        self, callback: Callable[[], Any], callback_group: CallbackGroup | None = None
    ) -> GuardCondition:
        """A new guard condition."""
        group = callback_group or self._default_callback_group
        guard = GuardCondition(callback, group, context=self._context)
        guard._wake = self._wake_executor
        return self._added_(self._guards, guard, group)  # type: ignore[no-any-return]

    def create_rate(self, frequency: float, clock: Clock | None = None) -> Rate:
        """A new rate."""
        if frequency <= 0:
            raise ValueError("frequency must be > 0")
        return Rate(self.create_timer(1.0 / frequency, None, self._rate_group, clock), context=self._context)

    def add_waitable(self, waitable: Any) -> None:
        """Lets the executor wait for an action."""
        self._added_(self._waitables_, waitable, None)

    def remove_waitable(self, waitable: Any) -> None:
        """Does not any more."""
        self._waitables_.remove(waitable)
        self._wake_executor()

    # ── destroying ──

    def destroy_node(self) -> None:
        """Destroys the node, and all that it has."""
        if self._is_destroyed_:
            return
        self._is_destroyed_ = True
        for waitable in self._waitables_[:]:
            waitable.destroy()
        for entities in (self._publishers, self._subscriptions, self._clients, self._services, self._timers, self._guards):
            while entities:
                self._destroy_(entities, entities[0])  # type: ignore[arg-type]
        if self in nodes:
            nodes.remove(self)
        self._wake_executor()

    def __enter__(self) -> Node:
        return self

    def __exit__(self, *of_exception: object) -> None:
        self.destroy_node()

    def _tell_of_parameters_(self, news: list[Parameter], changes: list[Parameter], gone: list[Parameter]) -> None:
        """Publishes an event, if anybody listens."""
        from rclpy import _parameter_events

        _parameter_events.tell(self, news, changes, gone)
