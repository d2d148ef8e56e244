#!/bin/bash
# A shell that calls what does not exist.
# expect: error "exit code 127"
exec no-such-program-at-all
