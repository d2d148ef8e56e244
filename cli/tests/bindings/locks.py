import threading

import rospy

first, second = threading.Lock(), threading.Lock()


def take(one, other):
    with one:
        rospy.sleep(0.5)
        with other:
            pass


rospy.init_node("brain")
threading.Thread(target=take, args=(first, second), name="left").start()
threading.Thread(target=take, args=(second, first), name="right").start()
