"""What a node may be called, twice, and anonymously."""
import warnings

import rospy


def tried(*args, **keys):
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            print(args, keys, rospy.init_node(*args, **keys), [str(w.message) for w in caught])
        except Exception as error:
            print(args, keys, type(error).__name__, str(error).split("(")[0], [str(w.message) for w in caught])


print(rospy.get_name(), rospy.get_namespace(), rospy.is_shutdown(), rospy.core.is_initialized(), rospy.get_node_uri())
tried("")
tried(None)
tried("a/b")
tried("/a")
tried()
tried("arm", anonymous=True)
name = rospy.get_name()
parts = name.split("_")
print(len(parts), parts[0], parts[1].isdigit(), parts[2].isdigit())
tried("arm", anonymous=True)
tried("arm")
tried("other")
print(rospy.get_name() == name, rospy.core.is_initialized(), rospy.get_namespace(), rospy.get_node_uri().startswith("http://"))
