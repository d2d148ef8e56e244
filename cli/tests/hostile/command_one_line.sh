#!/bin/bash
# A command of one line, which replaces itself.
# expect: error "it never spoke to the harness"
# run: sh -c 'exec sleep 1000'
