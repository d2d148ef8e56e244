"""Programs of ROS 1, and what they print."""

import unittest

from system import System
from tables import run_ros

SECOND = 10**9


def topic(name, **message):
    return {"topic": name, "message": message}


class Case(unittest.TestCase):
    def said(self, text, *args, **how):
        finished = run_ros(text, *args, **how)
        self.assertEqual((finished.code, finished.err), (0, ""), finished.err)
        return finished.out.splitlines()


class Nodes(Case):
    def test_names_and_remappings(self):
        text = """
            import rospy, sys
            from std_msgs.msg import String
            rospy.Subscriber("early", String)
            rospy.init_node("node")
            print(rospy.get_name(), rospy.get_namespace(), rospy.get_caller_id())
            for name in ("a", "/a", "~a", "a/b/", "", "other"):
                print(repr(name), rospy.resolve_name(name))
            print(rospy.myargv(), rospy.remap_name("other"), rospy.get_param("~speed"), rospy.get_param("~word"), rospy.get_param("~on"))
            rospy.init_node("node")
            try:
                rospy.init_node("another")
            except rospy.ROSException as error:
                print(str(error)[:58])
            """
        words = ["__name:=arm", "__ns:=/left", "other:=/shared", "_speed:=1.5", "_word:=abc", "_on:=true", "early:=late", "file.txt"]
        system = System()
        said = self.said(text, words=words, system=system)
        self.assertEqual(said[0], "/left/arm /left/ /left/arm")
        self.assertEqual(said[1:7], ["'a' /left/a", "'/a' /a", "'~a' /left/arm/a", "'a/b/' /left/a/b", "'' /left/", "'other' /shared"])
        self.assertTrue(said[7].endswith("node.py', 'file.txt'] /shared 1.5 abc True"), said[7])
        self.assertEqual(said[8], "rospy.init_node() has already been called with different a")
        self.assertEqual([port["name"] for port in system.ports.values()], ["/left/late"])

    def test_wrong_beginnings(self):
        text = """
            import rospy
            from std_msgs.msg import Int8
            def tried(call):
                try:
                    print(call())
                except (Exception, KeyboardInterrupt) as error:
                    print(type(error).__name__, error)
            pub = rospy.Publisher("a", Int8, queue_size=1)
            tried(lambda: pub.publish(1))
            tried(rospy.spin)
            tried(rospy.Time.now)
            tried(lambda: rospy.init_node("a/b"))
            tried(lambda: rospy.init_node(""))
            tried(lambda: rospy.Publisher("~a", Int8, queue_size=1))
            rospy.init_node("node", anonymous=True)
            tried(lambda: rospy.Publisher("", Int8))
            tried(lambda: rospy.Publisher("a", int))
            tried(lambda: rospy.Subscriber("a", Int8, queue_size=0))
            tried(lambda: pub.publish(1, 2))
            tried(lambda: pub.publish(data=1, date=2))
            tried(lambda: pub.publish(1, data=2))
            tried(lambda: pub.publish(1000))
            pub.unregister()
            tried(lambda: pub.publish(1))
            print(rospy.get_name().startswith("/node_"))
            """
        self.assertEqual(
            self.said(text),
            [
                "ROSException ROS node has not been initialized yet. Please call init_node() first",
                "ROSInitException client code must call rospy.init_node() first",
                "ROSInitException time is not initialized. Have you called init_node()?",
                "ValueError namespaces are not allowed in node names",
                "ValueError name must not be empty",
                "ValueError ~name topics cannot be created before init_node() has been called",
                "ValueError topic name is not a non-empty string",
                "ValueError data_class [type] is not a message data class",
                "ROSException queue size may not be set to zero",
                "TypeError Invalid number of arguments, args should be ['data'] args are(1, 2)",
                "AttributeError date is not an attribute of Int8",
                "TypeError publish() can be called with arguments or keywords, but not both.",
                "ROSSerializationException field data exceeds specified width [int8]",
                "ROSException publish() to an unregistered() handle",
                "True",
            ],
        )

    def test_the_end_of_a_node(self):
        text = """
            import rospy, threading
            from std_msgs.msg import Int8
            rospy.init_node("node")
            pub = rospy.Publisher("a", Int8, queue_size=1)
            rospy.on_shutdown(lambda: (print("client", rospy.is_shutdown()), pub.publish(7)))
            def end():
                rospy.sleep(2)
                rospy.signal_shutdown("enough")
                rospy.on_shutdown(lambda: print("late"))
            threading.Thread(target=end).start()
            rospy.spin()
            print(rospy.get_time(), rospy.is_shutdown())
            try:
                rospy.wait_for_message("b", Int8)
            except rospy.ROSInterruptException as error:
                print(error)
            """
        system = System()
        said = self.said(text, system=system)
        self.assertEqual(said, ["client False", "1735689602.0 True", "rospy shutdown", "late"])
        self.assertEqual(system.published, [(2 * SECOND, "/a", {"data": 7})])

    def test_hooks_at_the_end_of_the_program_can_publish(self):
        text = """
            import rospy
            from std_msgs.msg import Int8
            rospy.init_node("node")
            pub = rospy.Publisher("a", Int8, queue_size=1)
            rospy.on_shutdown(lambda: pub.publish(7))
            rospy.on_shutdown(lambda: 1 / 0)
            """
        system = System()
        finished = run_ros(text, system=system)
        self.assertEqual(finished.code, 0)
        self.assertIn("ZeroDivisionError", finished.err)
        self.assertEqual(system.published, [(0, "/a", {"data": 7})])
        self.assertEqual(finished.requests[-1], {"request": "done"})

    def test_the_test_is_over(self):
        text = """
            import rospy
            rospy.init_node("node")
            rospy.on_shutdown(lambda: print("hook"))
            while not rospy.is_shutdown():
                try:
                    rospy.sleep(1)
                except:
                    print("swallowed")
            print("end", rospy.get_time())
            """
        self.assertEqual(self.said(text, system=System(end=7 * SECOND // 2)), ["swallowed", "end 1735689603.5", "hook"])

    def test_a_loop_that_only_looks_whether_it_is_over(self):
        text = """
            import rospy
            rospy.init_node("node")
            for _ in range(999):
                rospy.is_shutdown()
            print(rospy.get_rostime().to_nsec() % 10**9)
            while not rospy.is_shutdown() and rospy.get_rostime().to_nsec() % 10**9 < 5 * 10**6:
                pass
            print(rospy.get_rostime().to_nsec() % 10**9)
            """
        self.assertEqual(self.said(text, system=System()), ["0", "5000000"])


class Topics(Case):
    def test_callbacks(self):
        text = """
            import rospy, threading
            from std_msgs.msg import Int8, String
            def one(message):
                print("one", message.data, rospy.get_time() % 60, threading.current_thread() is threading.main_thread())
            def two(message, args):
                print("two", message.data, args, message._connection_header["topic"])
            def bad(message):
                raise ValueError("bad value")
            rospy.init_node("node")
            first = rospy.Subscriber("a", Int8, one)
            second = rospy.Subscriber("a", Int8, two, callback_args=(1, 2))
            other = rospy.Subscriber("b", String, bad)
            rospy.sleep(1.5)
            first.unregister()
            rospy.sleep(5)
            second.unregister()
            print(second.name, second.impl)
            """
        system = System([(SECOND, topic("/a", data=1)), (2 * SECOND, topic("/a", data=2)), (3 * SECOND, topic("/b", data="x"))])
        finished = run_ros(text, system=system)
        self.assertEqual(
            finished.out.splitlines(),
            ["one 1 1.0 False", "two 1 (1, 2) /a", "two 2 (1, 2) /a", "/a None"],
        )
        self.assertTrue(finished.err.startswith("[ERROR] [1735689603.000000]: bad callback: <function bad at 0x"), finished.err)
        self.assertIn("ValueError: bad value", finished.err)
        self.assertEqual([port["name"] for port in system.ports.values()], ["/b"])

    def test_a_slow_callback_gets_the_newest(self):
        text = """
            import rospy
            from std_msgs.msg import Int8
            def slow(message):
                print(message.data)
                rospy.sleep(1)
            rospy.init_node("node")
            rospy.Subscriber("a", Int8, slow, queue_size=QUEUE)
            rospy.sleep(8)
            """
        arrivals = [(SECOND + n * SECOND // 4, topic("/a", data=n)) for n in range(6)]
        self.assertEqual(self.said(text.replace("QUEUE", "1"), system=System(arrivals)), ["0", "3", "5"])
        self.assertEqual(self.said(text.replace("QUEUE", "None"), system=System(arrivals)), list("012345"))

    def test_numbers_that_are_whole_messages(self):
        text = """
            import rospy
            from std_msgs.msg import Float32, Float64
            early = rospy.Publisher("a", Float64, queue_size=1)
            try:
                early.publish(0.5)
            except rospy.ROSException as error:
                print(error)
            rospy.init_node("node")
            for value in (0.1, -0.0, 1e300, float("inf"), float("nan"), 3, True, Float64(2.5)):
                early.publish(value)
            rospy.Publisher("b", Float32, queue_size=1, latch=True).publish(0.1)
            early.unregister()
            try:
                early.publish(0.5)
            except rospy.ROSException as error:
                print(error)
            """
        system = System()
        said = self.said(text, system=system)
        self.assertEqual(said[0], "ROS node has not been initialized yet. Please call init_node() first")
        self.assertEqual(said[1], "publish() to an unregistered() handle")
        numbers = [message["data"] for _, name, message in system.published if name == "/a"]
        self.assertEqual(list(map(repr, numbers)), ["0.1", "-0.0", "1e+300", "'inf'", "'nan'", "3.0", "1.0", "2.5"])
        self.assertEqual([message for _, name, message in system.published if name == "/b"], [{"data": 0.1}])

    def test_publishing(self):
        text = """
            import rospy
            from geometry_msgs.msg import Twist, Vector3, PoseStamped
            from std_msgs.msg import Int8
            rospy.init_node("node")
            pub = rospy.Publisher("cmd_vel", Twist, queue_size=1)
            pub.publish(Vector3(1, 0, 0), Vector3(0, 0, 0.5))
            pub.publish(Twist())
            pub.publish(linear=Vector3(x=2))
            poses = rospy.Publisher("pose", PoseStamped, queue_size=1)
            for _ in range(2):
                poses.publish(PoseStamped())
            rospy.Publisher("n", Int8, queue_size=1, latch=True).publish(3)
            try:
                pub.publish(Int8(1))
            except TypeError as error:
                print(error)
            """
        system = System()
        said = self.said(text, ["std_msgs", "geometry_msgs"], system=system)
        self.assertEqual(said, ["expected [geometry_msgs/Vector3] but got [std_msgs/Int8]"])
        messages = [message for _, _, message in system.published]
        zero = {"x": 0.0, "y": 0.0, "z": 0.0}
        self.assertEqual(messages[0], {"linear": {"x": 1.0, "y": 0.0, "z": 0.0}, "angular": {"x": 0.0, "y": 0.0, "z": 0.5}})
        self.assertEqual(messages[1:3], [{"linear": zero, "angular": zero}, {"linear": {**zero, "x": 2.0}, "angular": zero}])
        self.assertEqual([message["header"]["seq"] for message in messages[3:5]], [1, 2])
        self.assertEqual(system.latched, {"/n": {"data": 3}})

    def test_a_program_hears_itself(self):
        text = """
            import rospy
            from std_msgs.msg import String
            rospy.init_node("node")
            pub = rospy.Publisher("a", String, queue_size=1)
            rospy.Subscriber("a", String, lambda message: print("heard", message.data))
            print(pub.get_num_connections())
            pub.publish("me")
            print("published")
            rospy.sleep(1)
            """
        self.assertEqual(self.said(text), ["1", "published", "heard me"])

    def test_a_subscriber_made_at_every_poll_is_called_once(self):
        text = """
            import rospy
            from std_msgs.msg import Int8
            class Robot:
                count = 0
                def hear(self, message):
                    self.count += 1
                def poll(self):
                    rospy.Subscriber("a", Int8, self.hear)
                    rospy.Subscriber("a", Int8, lambda message: self.hear(message))
                    rospy.sleep(0.1)
            rospy.init_node("node")
            robot = Robot()
            for _ in range(100):
                robot.poll()
            print(robot.count)
            kept = [rospy.Subscriber("b", Int8, robot.hear) for _ in range(3)]
            rospy.sleep(5)
            print(robot.count)
            """
        system = System([(SECOND, topic("/a", data=1)), (12 * SECOND, topic("/b", data=1))])
        self.assertEqual(self.said(text, system=system), ["2", "5"])

    def test_wait_for_message(self):
        text = """
            import rospy
            from std_msgs.msg import Int8
            rospy.init_node("node")
            print(rospy.wait_for_message("a", Int8).data, rospy.get_time() % 60)
            print(rospy.wait_for_message("a", Int8, timeout=rospy.Duration(3)).data, rospy.get_time() % 60)
            try:
                rospy.wait_for_message("a", Int8, timeout=0.5)
            except rospy.ROSException as error:
                print(error, rospy.get_time() % 60)
            """
        system = System([(SECOND, topic("/a", data=1)), (3 * SECOND, topic("/a", data=2))])
        said = ["1 1.0", "2 3.0", "timeout exceeded while waiting for message on topic a 3.5"]
        self.assertEqual(self.said(text, system=system), said)
        a = {"request": "await", "kind": "subscriber", "name": "/a", "type": "std_msgs/Int8"}
        self.assertEqual(system.awaited, [a, {**a, "give_up": 4 * SECOND}, {**a, "give_up": 7 * SECOND // 2}])

    def test_waiting_for_a_message_costs_one_round_trip_and_no_thread(self):
        text = """
            import rospy, threading
            from hrdsl.link import the_link
            from std_msgs.msg import Int8
            rospy.init_node("node")
            started = []
            start = threading.Thread.start
            threading.Thread.start = lambda thread: (started.append(thread.name), start(thread))
            asked = the_link().asked
            for _ in range(3):
                print(rospy.wait_for_message("a", Int8).data)
            print(the_link().asked - asked, started)
            """
        system = System([(second * SECOND, topic("/a", data=second)) for second in (1, 2, 3)])
        self.assertEqual(self.said(text, system=system), ["1", "2", "3", "3 []"])
        self.assertEqual(system.ports, {})

    def test_a_subscriber_beside_one_who_waits_for_a_message(self):
        text = """
            import rospy, threading
            from std_msgs.msg import Int8
            rospy.init_node("node")
            def subscribe():
                rospy.sleep(1.5)
                rospy.Subscriber("a", Int8, lambda message: print("heard", message.data, threading.current_thread().name))
            threading.Thread(target=subscribe).start()
            print("got", rospy.wait_for_message("a", Int8).data)
            print("got", rospy.wait_for_message("a", Int8).data)
            rospy.sleep(2)
            """
        system = System([(second * SECOND, topic("/a", data=second)) for second in (1, 2, 3)])
        self.assertEqual(self.said(text, system=system), ["got 1", "heard 2 /a", "got 2", "heard 3 /a"])

    def test_waiting_for_what_is_no_such_message(self):
        text = """
            import rospy
            from std_msgs.msg import Int8, String
            rospy.init_node("node")
            rospy.Publisher("words", String, queue_size=1)
            for _ in range(2):
                try:
                    rospy.wait_for_message("words", Int8)
                except RuntimeError as error:
                    print(type(error).__name__, error)
            print(rospy.wait_for_message("a", Int8, timeout=5).data, rospy.get_time() % 60)
            """
        system = System([(SECOND, topic("/a", number=1)), (3 * SECOND, topic("/a", data=2))])
        told = "ProtocolError subscriber of /words (std_msgs/Int8): the topic `/words` is of type `std_msgs/String`, not `std_msgs/Int8`"
        finished = run_ros(text, system=system)
        self.assertEqual((finished.code, finished.out.splitlines()), (0, [told, told, "2 3.0"]), finished.err)
        self.assertEqual(finished.err.count("unable to receive a message on topic /a"), 1, finished.err)

    def test_connections_and_those_who_listen_to_them(self):
        text = """
            import rospy
            from std_msgs.msg import Int8
            class Listener(rospy.SubscribeListener):
                def peer_subscribe(self, topic_name, topic_publish, peer_publish):
                    print("came", topic_name, rospy.get_time() % 60)
                    peer_publish(Int8(5))
            rospy.init_node("node")
            pub = rospy.Publisher("a", Int8, Listener(), queue_size=1)
            while pub.get_num_connections() == 0:
                rospy.sleep(0.5)
            print(pub.get_num_connections(), rospy.get_time() % 60)
            print(rospy.get_published_topics())
            import rosgraph
            master = rosgraph.Master("/node")
            print(master.getPublishedTopics("/") == rospy.get_published_topics(), master.getTopicTypes(), rospy.get_rostime() == rospy.Time.now())
            """
        system = System([(SECOND + 5, lambda system: system.others_open("subscriber", "/a", "std_msgs/Int8"))])
        said = ["came /a 1.0", "1 1.5", "[['/a', 'std_msgs/Int8']]", "True [['/a', 'std_msgs/Int8']] True"]
        self.assertEqual(self.said(text, system=system), said)
        self.assertEqual(system.published, [(SECOND + 5, "/a", {"data": 5})])

    def test_who_listens_may_be_told_before_anything_is_published(self):
        text = """
            import rospy
            from std_msgs.msg import String
            class Listener(rospy.SubscribeListener):
                def peer_subscribe(self, topic_name, topic_publish, peer_publish):
                    print("came", topic_name, pub.name)
                    topic_publish(String("all"))
                    peer_publish(String("you"))
                def peer_unsubscribe(self, topic_name, num_peers):
                    print("went", topic_name, num_peers)
            pub = rospy.Publisher("a", String, subscriber_listener=Listener(), queue_size=1, latch=True)
            rospy.init_node("node")
            pub.publish("hello")
            rospy.sleep(1)
            own = rospy.Subscriber("a", String)
            rospy.sleep(1)
            own.unregister()
            rospy.sleep(1)
            """
        other = {"kind": "subscriber", "name": "/a", "type": "std_msgs/String", "program": "other"}
        system = System(others=[other])
        self.assertEqual(self.said(text, system=system), ["came /a /a", "came /a /a", "went /a 1"])
        self.assertEqual([message["data"] for _, _, message in system.published], ["hello", "all", "you", "all", "you"])

    def test_what_is_known_of_a_connection(self):
        text = """
            import rospy
            from std_msgs.msg import Int8
            from std_srvs.srv import Trigger
            def heard(message):
                header = message._connection_header
                print(message.data, header["topic"], header["type"], header["callerid"], "callerid" in header, "cookies" in header)
                print(header.get("callerid"), header.get("cookies", "none"), header["latching"])
            rospy.init_node("node")
            rospy.Subscriber("a", Int8, heard)
            rospy.sleep(1)
            pub = rospy.Publisher("a", Int8, queue_size=1)
            pub.publish(3)
            rospy.sleep(1)
            def serve(request):
                print(request._connection_header["callerid"], request._connection_header["service"])
                return True, ""
            rospy.Service("own", Trigger, serve)
            print(rospy.ServiceProxy("own", Trigger)()._connection_header["callerid"])
            print(rospy.ServiceProxy("far", Trigger)()._connection_header["callerid"])
            """
        system = System(
            [(SECOND // 2, topic("/a", data=2))], services={"/far": lambda message: {"success": True, "message": ""}}
        )
        system.others += [
            {"kind": "publisher", "name": "/a", "type": "std_msgs/Int8", "program": "camera"},
            {"kind": "server", "name": "/far", "type": "std_srvs/Trigger", "program": "camera"},
        ]
        said = self.said(text, system=system, packages=("std_msgs", "std_srvs"))
        self.assertEqual(
            said,
            [
                "2 /a std_msgs/Int8 /camera True False", "/camera none 0", "3 /a std_msgs/Int8 unknown True False", "unknown none 0",
                "/node /own", "/node", "/camera",
            ],
        )  # fmt: skip

    def test_a_second_subscriber_gets_what_is_latched_here(self):
        text = """
            import rospy
            from std_msgs.msg import Int8
            rospy.init_node("node")
            rospy.Publisher("a", Int8, queue_size=1, latch=True).publish(3)
            first = rospy.Subscriber("a", Int8, lambda message: print("first", message.data))
            rospy.sleep(1)
            second = rospy.Subscriber("a", Int8, lambda message: print("second", message.data))
            print("made")
            rospy.sleep(1)
            """
        self.assertEqual(self.said(text), ["first 3", "second 3", "made"])

    def test_what_is_no_message_of_the_type_is_told(self):
        text = """
            import rospy
            from std_msgs.msg import Int8
            rospy.init_node("node")
            rospy.Subscriber("a", Int8, lambda message: print(message.data))
            rospy.sleep(3)
            """
        finished = run_ros(text, system=System([(0, topic("/a", date=1)), (SECOND, topic("/a", data=1))]))
        self.assertEqual((finished.code, finished.out), (0, "1\n"))
        told = "unable to receive a message on topic /a: no std_msgs/Int8: there is no field 'data'"
        self.assertEqual(finished.err, "[ERROR] [1735689600.000000]: %s\n" % told)

    def test_a_topic_of_another_type(self):
        text = """
            import rospy
            from std_msgs.msg import Int8, String
            rospy.init_node("node")
            rospy.Publisher("a", Int8, queue_size=1)
            rospy.Subscriber("a", String)
            """
        finished = run_ros(text)
        self.assertEqual(finished.code, 1)
        self.assertIn("ProtocolError: the topic `/a` is of type `std_msgs/Int8`, not `std_msgs/String`", finished.err)

    def test_any_message(self):
        text = """
            import rospy
            from std_msgs.msg import String
            rospy.init_node("node")
            back = rospy.Publisher("b", String, queue_size=1)
            def hear(message):
                print(message._buff, String().deserialize(message._buff).data)
                back.publish(message)
            rospy.Subscriber("a", rospy.AnyMsg, hear)
            rospy.sleep(1)
            pub = rospy.Publisher("a", String, queue_size=1)
            rospy.sleep(1)
            pub.publish("hi")
            rospy.sleep(1)
            """
        system = System()
        self.assertEqual(self.said(text, system=system), ["b'\\x02\\x00\\x00\\x00hi' hi"])
        self.assertEqual(system.published[-1], (2 * SECOND, "/b", {"data": "hi"}))


class Times(Case):
    def test_rates_and_timers(self):
        text = """
            import rospy
            rospy.init_node("node")
            rate = rospy.Rate(4)
            for pause in (0, 0.1, 0.3, 0.9, 0):
                rospy.sleep(pause)
                rate.sleep()
                print("%.6f" % (rospy.get_time() % 60), rate.remaining().to_sec())
            def tick(event):
                print("tick %.6f" % (event.current_real.to_sec() % 60), event.last_real is None, (event.current_real - event.current_expected).to_sec())
            timer = rospy.Timer(rospy.Duration(0.5), tick)
            rospy.Timer(rospy.Duration(0.75), lambda event: print("once"), oneshot=True)
            rospy.sleep(1.2)
            timer.shutdown()
            rospy.sleep(rospy.Duration(-1))
            rospy.sleep(2)
            print(repr(rospy.Time.now()), rospy.Time.now() - rospy.Time(1735689600))
            """
        self.assertEqual(
            self.said(text),
            [
                "0.250000 0.25", "0.500000 0.25", "0.800000 0.2", "1.700000 0.25", "1.950000 0.25", "tick 2.450000 True 0.0", "once",
                "tick 2.950000 False 0.0",
                "rospy.Time[1735689605150000000] 5150000000",
            ],
        )  # fmt: skip


class Logs(Case):
    TEXT = """
        import rospy
        IMPORT
        rospy.logwarn("early %d", 1)
        rospy.loginfo("never seen")
        rospy.init_node("node", log_level=LEVEL)
        for log in (rospy.logdebug, rospy.loginfo, rospy.logwarn, rospy.logerr, rospy.logfatal):
            log("value %s of %d", "x", 5)
            log("100 %")
        for n in range(25):
            rospy.loginfo_throttle(1, "throttled %d" % n)
            rospy.loginfo_once("once %d" % n)
            rospy.loginfo_throttle_identical(10, "identical %d" % (n // 20))
            rospy.sleep(0.1)
        """
    OUT = [
        "[INFO] [1735689600.000000]: value x of 5",
        "[INFO] [1735689600.000000]: 100 %",
        "[INFO] [1735689600.000000]: throttled 0",
        "[INFO] [1735689600.000000]: once 0",
        "[INFO] [1735689600.000000]: identical 0",
        "[INFO] [1735689601.100000]: throttled 11",
        "[INFO] [1735689602.000000]: identical 1",
        "[INFO] [1735689602.200000]: throttled 22",
    ]
    ERR = ["early 1"] + [
        "[%s] [1735689600.000000]: %s" % (level, text) for level in ("WARN", "ERROR", "FATAL") for text in ("value x of 5", "100 %")
    ]

    def test_levels_and_forms(self):
        for more in ("", "import logging"):
            finished = run_ros(self.TEXT.replace("IMPORT", more).replace("LEVEL", "None"))
            self.assertEqual(finished.out.splitlines(), self.OUT)
            self.assertEqual(finished.err.splitlines(), self.ERR)
        finished = run_ros(self.TEXT.replace("IMPORT", "").replace("LEVEL", "rospy.DEBUG"))
        self.assertEqual(finished.out.splitlines()[0], "[DEBUG] [1735689600.000000]: value x of 5")
        finished = run_ros(self.TEXT.replace("IMPORT", "").replace("LEVEL", "rospy.ERROR"))
        self.assertEqual((finished.out, finished.err.splitlines()), ("", self.ERR[:1] + self.ERR[3:]))

    def test_logging_of_the_program(self):
        text = """
            import rospy
            rospy.init_node("node")
            import logging
            logging.warning("to a file")
            logging.getLogger("rosout").setLevel(logging.WARNING)
            rospy.loginfo("too low")
            rospy.logwarn("high enough", logger_name="part")
            try:
                1 / 0
            except ArithmeticError:
                rospy.logerr("failed", exc_info=True)
            """
        finished = run_ros(text)
        self.assertEqual(finished.out, "")
        lines = finished.err.splitlines()
        self.assertEqual(lines[:2], ["[WARN] [1735689600.000000]: high enough", "[ERROR] [1735689600.000000]: failed"])
        self.assertEqual(lines[-1], "ZeroDivisionError: division by zero")
        form = {"ROSCONSOLE_FORMAT": "${node} ${severity} ${function} ${message}"}
        text = "import rospy\nrospy.init_node('node')\ndef work():\n    rospy.loginfo('hi')\nwork()\n"
        self.assertEqual(self.said(text, env=form), ["/node INFO work hi"])


class Parameters(Case):
    def test_a_tree(self):
        text = """
            import rospy
            rospy.init_node("node")
            def tried(call):
                try:
                    print(call())
                except Exception as error:
                    print(type(error).__name__, error)
            print(rospy.get_param("/arm/speed"), rospy.get_param("arm"), rospy.get_param("~own"), rospy.get_param("no", 5))
            tried(lambda: rospy.get_param("no"))
            rospy.set_param("~gains", {"p": 1.5, "list": (1, 2)})
            print(rospy.get_param("/node/gains/p"), rospy.get_param("~gains"), rospy.has_param("~gains/i"), rospy.has_param("~gains"))
            print(rospy.search_param("speed"), rospy.search_param("gains/i"), rospy.search_param("nothing"))
            rospy.delete_param("~gains")
            tried(lambda: rospy.delete_param("~gains"))
            tried(lambda: rospy.set_param("x", None))
            tried(lambda: rospy.set_param("x", {1: 2}))
            print(sorted(rospy.get_param_names()))
            """
        parameters = {"/arm/speed": 0.2, "/arm": {"speed": 0.2, "joints": ["a"]}, "/node/own": True, "speed": 3}
        self.assertEqual(
            self.said(text, system=System(parameters=parameters)),
            [
                "0.2 {'speed': 0.2, 'joints': ['a']} True 5",
                "KeyError 'no'",
                "1.5 {'p': 1.5, 'list': [1, 2]} False True",
                "/speed /node/gains/i None",
                "KeyError '~gains'",
                "TypeError cannot marshal None unless allow_none is enabled",
                "TypeError dictionary key must be string",
                "['/arm/joints', '/arm/speed', '/node/own', '/speed']",
            ],
        )

    def test_private_ones_of_the_command_line(self):
        words = {
            "a": "1e3", "b": "1.5e+3", "c": "0x10", "d": "010", "e": "1_000", "f": "Off", "g": "'yes'", "h": "[1, two, [3.0, ~]]",
            "i": "{p: 1, 'q r': [on, \"x\\ty\"]}", "j": "a: b", "k": "-.inf", "l": "08", "m": "a b # c", "n": "[]", "o": "-7",
        }  # fmt: skip
        text = """
            import rospy
            rospy.init_node("node", argv=%r)
            print(rospy.get_param("~"))
            """
        given = ["_%s:=%s" % pair for pair in words.items() if pair[0] not in "jh"] + ["_h:=[1, two, [3.0]]", "__log:=x", "_:=1", "plain"]
        expected = {
            "a": "1e3", "b": 1500.0, "c": 16, "d": 8, "e": 1000, "f": False, "g": "yes", "i": {"p": 1, "q r": [True, "x\ty"]},
            "k": float("-inf"), "l": "08", "m": "a b", "n": [], "o": -7, "h": [1, "two", [3.0]],
        }  # fmt: skip
        self.assertEqual(self.said(text % given), [str(expected)])
        for word, told in (
            ("a: b", "a mapping stands between braces, a list between brackets: a: b"),
            ("[1 2", "there is no ] where it is due: [1 2"),
            ("{a b", "there is no } where it is due: {a b"),
            ("'a' b", "there is something behind the value: 'a' b"),
            ("'a", "a quote is never closed: 'a"),
            ("&a 1", "& cannot begin a value here; put the value between quotes"),
        ):
            finished = run_ros(text % (["_x:=" + word],))
            self.assertEqual(finished.code, 1)
            self.assertIn("ROSInitException: invalid command-line parameters: %s\n" % told, finished.err)

    def test_values_that_json_does_not_have_and_loops_that_look(self):
        text = """
            import rospy
            rospy.init_node("node")
            for value in (float("nan"), [float("-inf"), {"a": b"\\0\\xff"}], {"/float": 1, "b": 2}, 0.1, 1e22, -0.0, "\\u00fc\\n"):
                rospy.set_param("~value", value)
                print(repr(rospy.get_param("~value")))
            try:
                rospy.set_param("~value", "\\ud800")
            except UnicodeEncodeError:
                print("half a character")
            while not rospy.has_param("/there"):
                pass
            print(rospy.get_time() >= 1735689601, rospy.get_param("/there/it"))
            """
        def later(system):
            system.do_set_parameter({"name": "/there", "value": {"it": "is"}})

        self.assertEqual(
            self.said(text, system=System([(SECOND, later)], end=100 * SECOND)),
            [
                "nan", "[-inf, {'a': b'\\x00\\xff'}]", "{'/float': 1, 'b': 2}", "0.1", "1e+22", "-0.0", "'\u00fc\\n'",
                "half a character", "True is",
            ],
        )  # fmt: skip

    def test_names_of_parameters(self):
        text = """
            import rospy
            rospy.init_node("node")
            print(rospy.search_param("gain"), rospy.search_param("far"), rospy.search_param("/gain"), rospy.search_param("own"))
            rospy.set_param("gain", 3)
            rospy.set_param("~gain", {"p": 1})
            print(rospy.get_param("gain"), rospy.get_param("/left/gain"), rospy.get_param("~gain/p"), rospy.get_param_cached("/gain"))
            print(rospy.search_param("gain"), rospy.has_param("~gain"), rospy.has_param("gain/p"), rospy.has_param("/left"))
            rospy.delete_param("~gain/p")
            print(sorted(rospy.get_param_names()), rospy.get_param("~gain"))
            print(rospy.get_param("speed"), rospy.search_param("speed"))
            """
        parameters = {"/gain": 1, "/left/far": 2, "/fast": 9}
        words = ["__ns:=left", "speed:=/fast", "_own:=1"]
        self.assertEqual(
            self.said(text, words=words, system=System(parameters=parameters)),
            [
                "/gain /left/far /gain /left/node/own",
                "3 3 1 1",
                "/left/node/gain True False True",
                "['/fast', '/gain', '/left/far', '/left/gain', '/left/node/own'] {}",
                "9 /fast",
            ],
        )

    def test_packages(self):
        text = """
            import rospkg, roslib, rosgraph, roslib.packages
            roslib.load_manifest("robot")
            print(rospkg.RosPack().get_path("robot"), rospkg.RosPack().list(), roslib.packages.get_pkg_dir("robot"))
            try:
                rospkg.RosPack().get_path("other")
            except rospkg.ResourceNotFound as error:
                print(error)
            print(rosgraph.names.is_legal_name("a b"), rosgraph.names.ns_join("/a", "b"), rosgraph.is_master_online())
            """
        self.assertEqual(
            self.said(text, binding={"packages": {"robot": "/opt/robot"}}),
            ["/opt/robot ['robot'] /opt/robot", "other", "False /a/b True"],
        )


class Packages(Case):
    def test_a_package_of_the_program_has_its_messages_beside(self):
        text = """
            import robot_msgs, table_simulator.msg, other_msgs.msg
            from robot_msgs.tools import name
            from robot_msgs.msg import Order
            print(name, robot_msgs.__file__ is not None, Order(1), table_simulator.msg.State(), other_msgs.msg.Other._type)
            """
        more = {"robot_msgs__Order": "int8 number\n", "table_simulator__State": "bool done\n", "other_msgs__Other": ""}
        files = {
            "robot_msgs/__init__.py": "",
            "robot_msgs/tools.py": "name = 'tools'\n",
            "robot_msgs/msg/Order.msg": "int8 number\n",
            "table_simulator/msg/State.msg": "bool done\n",
        }
        self.assertEqual(self.said(text, more=more, files=files), ["tools True number: 1 done: False other_msgs/Other"])

    def test_arrays_of_numpy(self):
        try:
            import numpy  # noqa: F401
        except ImportError:
            self.skipTest("NumPy is not installed")
        text = """
            import numpy, rospy
            from rospy.numpy_msg import numpy_msg
            from sensor_msgs.msg import LaserScan
            rospy.init_node("node")
            pub = rospy.Publisher("a", numpy_msg(LaserScan), queue_size=1)
            rospy.Subscriber("a", numpy_msg(LaserScan), lambda message: print(type(message.ranges).__name__, message.ranges * 2))
            scan = LaserScan(ranges=numpy.array([1, 2.5], numpy.float32), angle_min=numpy.float64(0.5))
            pub.publish(scan)
            rospy.sleep(1)
            """
        self.assertEqual(self.said(text, ["sensor_msgs"]), ["ndarray [2. 5.]"])


if __name__ == "__main__":
    unittest.main()
