"""Reads MCAP files with Python's reader, checks each message against the schema of its channel, and prints the topics with their counts."""

import collections
import json
import sys

sys.path.insert(0, sys.argv[1])

from jsonschema import Draft202012Validator  # noqa: E402
from mcap.reader import make_reader  # noqa: E402

for path in sys.argv[2:]:
    counts = collections.Counter()
    validators = {}
    with open(path, "rb") as file:
        reader = make_reader(file, validate_crcs=True)
        statistics = reader.get_summary().statistics
        for schema, channel, message in reader.iter_messages(log_time_order=False):
            assert schema.encoding == "jsonschema" and channel.message_encoding == "json", channel
            if schema.name not in validators:
                document = json.loads(schema.data)
                Draft202012Validator.check_schema(document)
                validators[schema.name] = Draft202012Validator(document)
            validators[schema.name].validate(json.loads(message.data))
            counts[channel.topic] += 1
    assert statistics.message_count == sum(counts.values()), (statistics, counts)
    print(path, dict(sorted(counts.items())))
