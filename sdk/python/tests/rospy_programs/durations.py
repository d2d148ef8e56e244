"""`Duration`: how it is made, printed, compared and calculated with."""
import copy
import pickle

import genpy
import rospy
from rospy import Duration, Time


def tried(text):
    try:
        print(text, "=", repr(eval(text)))
    except Exception as error:
        print(text, "!", type(error).__name__, error)


for text in (
    "Duration()", "Duration(1)", "Duration(1.5)", "Duration(-1.5)", "Duration(1, 1500000000)", "Duration(1, -1)",
    "Duration(-1, 5)", "Duration(1.5, 5)", "Duration('1')", "Duration(None)", "Duration(secs=1, nsecs=2)", "Duration(0.1)",
    "Duration.from_sec(2.25)", "Duration.from_sec(-0.25)", "Duration.from_sec('x')", "str(Duration(1.5))",
    "str(Duration(-0.5))", "Duration(1.5).secs", "Duration(1.5).nsecs", "Duration(-0.5).secs", "Duration(-0.5).nsecs",
    "Duration(1.5).to_sec()", "Duration(1.5).to_nsec()", "Duration(1) + Duration(0.5)", "Duration(1) - Duration(1.5)",
    "Duration(1) + 1", "1 + Duration(1)", "Duration(1) - 1.0", "Duration(1) * 2", "2 * Duration(1)", "Duration(1) * 0.5",
    "0.5 * Duration(1)", "Duration(1) * Duration(1)", "Duration(1) * '2'", "Duration(3) / 2", "Duration(3) / 2.0",
    "Duration(3) / Duration(2)", "Duration(3) // 2", "Duration(3) // Duration(2)", "Duration(3) / 0", "Duration(3) % 2",
    "Duration(3) % Duration(2)", "divmod(Duration(3), Duration(2))", "divmod(Duration(3), 2)", "-Duration(1.5)",
    "abs(Duration(-1.5))", "abs(Duration(1.5))", "+Duration(1)", "bool(Duration())", "bool(Duration(1))", "float(Duration(1))",
    "int(Duration(1))", "Duration(1) == Duration(1)", "Duration(1) == 1", "Duration(1) != Duration(2)",
    "Duration(1) == genpy.Duration(1)", "Duration(1) < Duration(2)", "Duration(1) < 2", "Duration(1) >= Duration(1)",
    "Duration(1) == Time(1)", "Duration(1) < Time(2)", "Duration(1) > None", "hash(Duration(1)) == hash(Duration(1))",
    "len({Duration(1), Duration(1), Duration(2)})", "sorted([Duration(2), Duration(1)])", "max(Duration(2), Duration(1))",
    "sum([Duration(1), Duration(2)], Duration())", "type(Duration(1) + Duration(1)).__module__",
    "type(-Duration(1)).__module__", "copy.deepcopy(Duration(1, 2))", "pickle.loads(pickle.dumps(Duration(1, 2)))",
    "genpy.Duration(1)", "Duration(1).is_zero()", "Duration(10**10)", "Duration(1e10)", "Duration(True)",
    "Duration.from_sec(1).__class__", "'%s' % Duration(2)", "'{}'.format(Duration(2))", "Duration(1).from_seconds(1)",
    "Duration(float('nan'))", "Duration(float('inf'))", "Duration(1).foo",
):  # fmt: skip
    tried(text)
