"""Compares a table of definitions with the types that rosbags knows, and its sums with those that rosbags computes.

python3 rosbags_compare.py PACKAGES TABLE: the folder that holds rosbags, and the table as JSON. What differs is printed, and the exit
status says whether anything does.
"""

import json
import sys
from keyword import iskeyword

sys.path.insert(0, sys.argv[1])

from rosbags.interfaces import Nodetype  # noqa: E402
from rosbags.typesys import Stores, get_types_from_msg, get_typestore  # noqa: E402

# rosbags has these as messages in both versions; in ROS 1 they are primitive types.
TIMES = {"time": "builtin_interfaces/msg/Time", "duration": "builtin_interfaces/msg/Duration"}
# What a message without fields has on the wire of ROS 2.
FILLER = "structure_needs_at_least_one_member"
# The fewest types that are to be compared: a store that is not found would agree with everything.
FEWEST = 140


def long_name(name):
    package, *space, own = name.split("/")
    return "/".join([package, *(space or ["msg"]), own])


def field_of(row):
    """A field of the table, as rosbags has it."""
    of = TIMES.get(row["type"], row["type"])
    if "/" in of:
        inner = (Nodetype.NAME, long_name(of))
    else:
        inner = (Nodetype.BASE, (of, row.get("characters", 0)))
    # rosbags appends a bar to names that Python keeps for itself.
    name = row["name"] + "_" * iskeyword(row["name"])
    array = row.get("array")
    if array is None:
        return name, inner
    if array == "any":
        return name, (Nodetype.SEQUENCE, (inner, 0))
    ((kind, number),) = array.items()
    return name, (Nodetype.ARRAY if kind == "exactly" else Nodetype.SEQUENCE, (inner, number))


def definition_of(row):
    constants = [(constant["name"], constant["type"], constant["value"]) for constant in row["constants"]]
    return constants, [field_of(field) for field in row["fields"]]


def compare_types(store, rows):
    """What differs, of the types that rosbags has."""
    compared, different = 0, []
    for name, (constants, fields) in store.fielddefs.items():
        if name in TIMES.values() and name not in rows:
            continue
        compared += 1
        if name not in rows:
            different.append(f"{name} is missing")
            continue
        theirs = (list(constants), [field for field in fields if field[0] != FILLER])
        ours = definition_of(rows[name])
        if repr(ours) != repr(theirs):
            different.append(f"{name}:\n  {ours}\n  {theirs}")
    if compared < FEWEST:
        different.append(f"only {compared} types were compared")
    return compared, different


def compare_sums(rows):
    """What differs, of the sums that rosbags computes from our own texts."""
    store = get_typestore(Stores.EMPTY)
    types = {}
    for name, row in rows.items():
        types.update(get_types_from_msg(row["text"], name))
    store.register({name: definition for name, definition in types.items() if name not in store.fielddefs})
    different = []
    for name, row in rows.items():
        _, md5 = store.generate_msgdef(name)
        if md5 != row["md5"]:
            different.append(f"{name}: {row['md5']}, and rosbags has {md5}")
    return different


def main():
    with open(sys.argv[2], encoding="utf-8") as file:
        table = json.load(file)
    is_first = table["ros"] == 1
    rows = {f"{row['package']}/msg/{row['name'].split('/')[-1]}" if is_first else row["name"]: row for row in table["messages"]}
    store = get_typestore(Stores.ROS1_NOETIC if is_first else Stores.ROS2_HUMBLE)
    compared, different = compare_types(store, rows)
    if is_first:
        known = {name: row for name, row in rows.items() if name in store.fielddefs}
        for name, row in known.items():
            _, md5 = store.generate_msgdef(name)
            if md5 != row["md5"]:
                different.append(f"{name}: {row['md5']}, and in the store of rosbags {md5}")
        different += compare_sums(rows)
    print(f"{compared} types are compared, {len(different)} differ")
    print("\n".join(different))
    return bool(different)


sys.exit(main())
