#!/bin/bash
# A command that does not exist.
# expect: error "not found"
# run: no-such-program-at-all
