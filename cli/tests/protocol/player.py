"""Plays a dialog of the lock-step protocol: sends what stands after `>`, and compares each reply with what stands after `<`.

    player.py DIALOG

Lines that begin with `#` say what follows. It needs no SDK: whoever writes a client library finds here what a harness answers.
"""

import json
import os
import sys

requests = int(os.environ["HRDSL_REQUEST_FD"])
replies = open(int(os.environ["HRDSL_REPLY_FD"]), "rb")

with open(sys.argv[1]) as dialog:
    for number, line in enumerate(dialog, 1):
        side, text = line[:2], line[2:].encode()
        if side == "> ":
            os.write(requests, text)
        elif side == "< ":
            reply = replies.readline()
            if not reply or json.loads(reply) != json.loads(text):
                sys.exit("%s:%d: expected %r, got %r" % (sys.argv[1], number, text, reply))
        elif line.strip() and not line.startswith("#"):
            sys.exit("%s:%d: neither `>` nor `<`" % (sys.argv[1], number))
