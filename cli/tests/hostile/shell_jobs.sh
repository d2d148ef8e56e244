#!/bin/bash
# A shell that leaves jobs and ends.
# expect: error "the program ended (exit code 0)"
trap '' TERM HUP INT
setsid sleep 1000 &
nohup sleep 1000 >/dev/null 2>&1 &
disown -a
exit 0
