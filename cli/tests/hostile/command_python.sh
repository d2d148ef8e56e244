#!/bin/bash
# A line of Python, which runs without the harness's help.
# expect: error "exit code 5"
# run: python3 -c 'raise SystemExit(5)'
