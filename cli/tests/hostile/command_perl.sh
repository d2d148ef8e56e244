#!/bin/bash
# Perl that forks, and whose parent ends.
# expect: any
# run: perl -e 'exit 3 if fork; sleep 1000'
