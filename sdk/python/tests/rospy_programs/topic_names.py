"""What topics may be called, and of which classes they may be."""
import warnings

import rospy
from std_msgs.msg import Int32, String
from std_srvs.srv import Trigger

for call in (
    lambda: rospy.Publisher("~private", String, queue_size=1), lambda: rospy.Publisher("early", String, queue_size=1).publish("x"),
    rospy.spin, lambda: rospy.wait_for_message("a", String, 0.1), lambda: rospy.get_published_topics() is None,
):  # fmt: skip
    try:
        print(call())
    except Exception as error:
        print(type(error).__name__, error)
rospy.init_node("topic_names")
for kind in (rospy.Publisher, rospy.Subscriber):
    more = {"queue_size": 1}
    for args in (("", String), (None, String), (5, String), ("a b", String), ("1a", String), ("/a//b", String), ("a", None), ("b", int),
                 ("c", "String"), ("d", String()), ("e", Trigger), ("f",), ("same", String), ("same", Int32), ("~x/y", String)):  # fmt: skip
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            try:
                made = kind(*args, **more)
                print(kind.__name__, args[0], made.name, made.type, made.data_class.__name__, [str(w.message) for w in caught if w.category is UserWarning])
            except Exception as error:
                text = str(error).replace(kind.__name__ + ".", "")
                print(kind.__name__, args[0], type(error).__name__, text, [str(w.message) for w in caught if w.category is UserWarning])
