"""What `roslib` has besides `load_manifest`."""
# stderr
import warnings

import roslib
import roslib.exceptions
import roslib.launcher
import roslib.message
import roslib.names
import roslib.packages
import roslib.scriptutil
from std_msgs.msg import Header


def tried(call):
    try:
        print(repr(call()))
    except Exception as error:
        print(type(error).__name__, error)


print(roslib.is_interactive(), roslib.set_interactive(True), roslib.is_interactive(), roslib.launcher.load_manifest is roslib.load_manifest)
print(issubclass(roslib.packages.InvalidROSPkgException, roslib.packages.ROSPkgException), roslib.exceptions.ROSLibException.__mro__[1].__name__)
names = roslib.names
print(names.resource_name("a", "B"), names.resource_name("a", "B", my_pkg="a"), names.resource_name_base("a/B"), names.resource_name_base("B"))
print(names.resource_name_package("a/B"), names.resource_name_package("B"), names.package_resource_name("a/B"), names.package_resource_name("B"))
tried(lambda: names.package_resource_name("a/b/c"))
for name in (None, "a", "a/b", "a//b", "/a", "1", "a b", "a_", ""):
    print(repr(name), names.is_legal_resource_name(name), names.is_legal_resource_base_name(name))
print(names.PRN_SEPARATOR, names.TYPE_SEPARATOR, names.SEP, names.REMAP, names.ANYTYPE, names.ns_join("/a", "b"))
for name in ("String", "Header", "no/Thing", "a/b/c"):
    tried(lambda: roslib.message.get_message_class(name))
print(roslib.message.get_message_class("Header") is Header, roslib.message.get_service_class("std_srvs/Empty").__name__)
print([getattr(roslib.message, name).__name__ for name in ("Time", "Duration", "TVal", "Message", "SerializationError", "DeserializationError")])
with warnings.catch_warnings(record=True) as seen:
    warnings.simplefilter("always")
    print([roslib.scriptutil.script_resolve_name("script", name) for name in ("~x", "", "/g", "y")], [str(warning.message) for warning in seen])
