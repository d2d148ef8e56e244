"""Quality of service: how deep queues are, and whether late subscribers get what was published before."""

from __future__ import annotations

from enum import Enum, IntEnum

from rclpy._rclpy_pybind11 import QoSCompatibility as QoSCompatibility
from rclpy.duration import Duration

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any


class QoSPolicyKind(IntEnum):
    """The policies."""

    INVALID = 1
    DURABILITY = 2
    DEADLINE = 4
    LIVELINESS = 8
    RELIABILITY = 16
    HISTORY = 32
    LIFESPAN = 64
    DEPTH = 128
    LIVELINESS_LEASE_DURATION = 256
    AVOID_ROS_NAMESPACE_CONVENTIONS = 512


def qos_policy_name_from_kind(policy_kind: int) -> str:
    """A policy's name."""
    return QoSPolicyKind(policy_kind).name


class InvalidQoSProfileException(Exception):
    """A profile lacks something."""

    def __init__(self, *args: Any) -> None:
        super().__init__("Invalid QoSProfile", *args)


class QoSPolicyEnum(IntEnum):
    """The base of a policy's values."""

    @classmethod
    def short_keys(cls) -> list[str]:
        """The names in small letters."""
        return [key.lower() for key in cls.__members__]

    @classmethod
    def get_from_short_key(cls, name: str) -> int:
        """The value of such a name."""
        return cls[name.upper()].value

    @property
    def short_key(self) -> str:
        """Its name in small letters."""
        return self.name.lower()


def _enumeration(name: str, doc: str, prefix: str, **values: int) -> Any:
    """An enumeration whose members have their long names of before Foxy, too."""
    made: Any = QoSPolicyEnum(name, values, module=__name__)  # type: ignore[call-overload]
    made.__doc__ = doc
    for key in values:
        type.__setattr__(made, prefix + key, made[key])
    return made


HistoryPolicy = _enumeration(
    "HistoryPolicy",
    "How much of what waits is kept.",
    "RMW_QOS_POLICY_HISTORY_",
    SYSTEM_DEFAULT=0,
    KEEP_LAST=1,
    KEEP_ALL=2,
    UNKNOWN=3,
)
ReliabilityPolicy = _enumeration(
    "ReliabilityPolicy",
    "Whether messages may be lost on the way; none is, here.",
    "RMW_QOS_POLICY_RELIABILITY_",
    SYSTEM_DEFAULT=0,
    RELIABLE=1,
    BEST_EFFORT=2,
    UNKNOWN=3,
    BEST_AVAILABLE=4,
)
DurabilityPolicy = _enumeration(
    "DurabilityPolicy",
    "Whether those who subscribe later get the last message.",
    "RMW_QOS_POLICY_DURABILITY_",
    SYSTEM_DEFAULT=0,
    TRANSIENT_LOCAL=1,
    VOLATILE=2,
    UNKNOWN=3,
    BEST_AVAILABLE=4,
)
LivelinessPolicy = _enumeration(
    "LivelinessPolicy",
    "How publishers show that they live.",
    "RMW_QOS_POLICY_LIVELINESS_",
    SYSTEM_DEFAULT=0,
    AUTOMATIC=1,
    MANUAL_BY_TOPIC=3,
    UNKNOWN=4,
    BEST_AVAILABLE=5,
)
QoSHistoryPolicy = HistoryPolicy
QoSReliabilityPolicy = ReliabilityPolicy
QoSDurabilityPolicy = DurabilityPolicy
QoSLivelinessPolicy = LivelinessPolicy

_UNSPECIFIED = Duration()

#: What a profile has of each policy: its kind, and its default.
_POLICIES: dict[str, tuple[Any, Any]] = {
    "history": (HistoryPolicy, None),
    "depth": (int, 10),
    "reliability": (ReliabilityPolicy, ReliabilityPolicy.RELIABLE),
    "durability": (DurabilityPolicy, DurabilityPolicy.VOLATILE),
    "lifespan": (Duration, _UNSPECIFIED),
    "deadline": (Duration, _UNSPECIFIED),
    "liveliness": (LivelinessPolicy, LivelinessPolicy.SYSTEM_DEFAULT),
    "liveliness_lease_duration": (Duration, _UNSPECIFIED),
    "avoid_ros_namespace_conventions": (bool, False),
}


def _policy(name: str) -> Any:
    kind = _POLICIES[name][0]
    slot = "_" + name

    def put(self: QoSProfile, value: Any) -> None:
        if kind in (int, bool, Duration):
            assert isinstance(value, kind)
            setattr(self, slot, value)
        else:
            assert isinstance(value, int)
            setattr(self, slot, kind(value))

    return property(lambda self: getattr(self, slot), put, None, "The policy %r." % name)


class QoSProfile:
    """A value of each policy."""

    __slots__ = ["_" + name for name in _POLICIES]

    def __init__(self, **kwargs: Any) -> None:
        assert all(key in _POLICIES for key in kwargs), "Invalid arguments passed to constructor: %r" % kwargs.keys()
        if "history" not in kwargs:
            if "depth" not in kwargs:
                raise InvalidQoSProfileException("History and/or depth settings are required.")
            kwargs["history"] = HistoryPolicy.KEEP_LAST
        if kwargs["history"] == HistoryPolicy.KEEP_LAST and "depth" not in kwargs:
            raise InvalidQoSProfileException("History set to KEEP_LAST without a depth setting.")
        for name, (_, default) in _POLICIES.items():
            setattr(self, name, kwargs.get(name, default))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, QoSProfile):
            return False
        return all(getattr(self, slot) == getattr(other, slot) for slot in QoSProfile.__slots__)

    __hash__ = None  # type: ignore[assignment]

    def __str__(self) -> str:
        return "%s(%s)" % (
            type(self).__name__,
            ", ".join("%s=%s" % (slot[1:], getattr(self, slot)) for slot in QoSProfile.__slots__),
        )


for _name in _POLICIES:
    setattr(QoSProfile, _name, _policy(_name))


_RELIABILITIES = {ReliabilityPolicy.RELIABLE: "reliable", ReliabilityPolicy.BEST_EFFORT: "best_effort"}
_DURABILITIES = {DurabilityPolicy.VOLATILE: "volatile", DurabilityPolicy.TRANSIENT_LOCAL: "transient_local"}


def options_of(profile: QoSProfile) -> dict[str, Any]:
    """How a port with this profile is opened; what a profile leaves to the middleware fits everything."""
    return {
        "depth": depth_of(profile),
        "reliability": _RELIABILITIES.get(profile._reliability),  # type: ignore[attr-defined]
        "durability": _DURABILITIES.get(profile._durability),  # type: ignore[attr-defined]
    }


def depth_of(profile: QoSProfile) -> int | None:
    """How many messages wait for a subscription; None for all."""
    if profile._history == HistoryPolicy.KEEP_ALL:  # type: ignore[attr-defined]
        return None
    return max(1, profile._depth)  # type: ignore[attr-defined]


qos_profile_unknown = QoSProfile(
    history=HistoryPolicy.UNKNOWN,
    depth=0,
    reliability=ReliabilityPolicy.UNKNOWN,
    durability=DurabilityPolicy.UNKNOWN,
    liveliness=LivelinessPolicy.UNKNOWN,
)
qos_profile_default = QoSProfile(depth=10)
qos_profile_system_default = QoSProfile(
    history=HistoryPolicy.SYSTEM_DEFAULT,
    depth=0,
    reliability=ReliabilityPolicy.SYSTEM_DEFAULT,
    durability=DurabilityPolicy.SYSTEM_DEFAULT,
)
qos_profile_sensor_data = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)
qos_profile_services_default = QoSProfile(depth=10)
qos_profile_parameters = QoSProfile(depth=1000)
qos_profile_parameter_events = QoSProfile(depth=1000)
qos_profile_action_status_default = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
qos_profile_best_available = QoSProfile(
    depth=10,
    reliability=ReliabilityPolicy.BEST_AVAILABLE,
    durability=DurabilityPolicy.BEST_AVAILABLE,
    liveliness=LivelinessPolicy.BEST_AVAILABLE,
)


class QoSPresetProfiles(Enum):
    """The profiles that have names."""

    UNKNOWN = qos_profile_unknown
    DEFAULT = qos_profile_default
    SYSTEM_DEFAULT = qos_profile_system_default
    SENSOR_DATA = qos_profile_sensor_data
    SERVICES_DEFAULT = qos_profile_services_default
    PARAMETERS = qos_profile_parameters
    PARAMETER_EVENTS = qos_profile_parameter_events
    ACTION_STATUS_DEFAULT = qos_profile_action_status_default
    BEST_AVAILABLE = qos_profile_best_available

    @classmethod
    def short_keys(cls) -> list[str]:
        """The names in small letters."""
        return [key.lower() for key in cls.__members__]

    @classmethod
    def get_from_short_key(cls, name: str) -> QoSProfile:
        """The profile of such a name."""
        return cls[name.upper()].value


def incompatible_policy(publisher: Any, subscription: Any) -> QoSPolicyKind | None:
    """The policy for which a subscription asks for more than the publisher offers, if there is one."""
    if (
        publisher.reliability == ReliabilityPolicy.BEST_EFFORT
        and subscription.reliability == ReliabilityPolicy.RELIABLE
    ):
        return QoSPolicyKind.RELIABILITY
    if (
        publisher.durability == DurabilityPolicy.VOLATILE
        and subscription.durability == DurabilityPolicy.TRANSIENT_LOCAL
    ):
        return QoSPolicyKind.DURABILITY
    wanted, offered = subscription.deadline.nanoseconds, publisher.deadline.nanoseconds
    if wanted and (not offered or offered > wanted):
        return QoSPolicyKind.DEADLINE
    if (
        publisher.liveliness == LivelinessPolicy.AUTOMATIC
        and subscription.liveliness == LivelinessPolicy.MANUAL_BY_TOPIC
    ):
        return QoSPolicyKind.LIVELINESS
    wanted = subscription.liveliness_lease_duration.nanoseconds
    offered = publisher.liveliness_lease_duration.nanoseconds
    if wanted and (not offered or offered > wanted):
        return QoSPolicyKind.LIVELINESS
    return None


_REASONS = {
    QoSPolicyKind.RELIABILITY: "Best effort publisher and reliable subscription;",
    QoSPolicyKind.DURABILITY: "Volatile publisher and transient local subscription;",
    QoSPolicyKind.DEADLINE: "Publisher's deadline is greater than subscription's deadline;",
    QoSPolicyKind.LIVELINESS: "Publisher's liveliness is weaker than the subscription's;",
}


def qos_check_compatible(publisher_qos: QoSProfile, subscription_qos: QoSProfile) -> tuple[QoSCompatibility, str]:
    """Whether a publisher and a subscription with these profiles can talk, and why not."""
    policy = incompatible_policy(publisher_qos, subscription_qos)
    if policy is not None:
        return QoSCompatibility.ERROR, "ERROR: " + _REASONS[policy]
    return QoSCompatibility.OK, ""
