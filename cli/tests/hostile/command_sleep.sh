#!/bin/bash
# A command of the system that sleeps.
# expect: error "it never spoke to the harness"
# run: sleep 1000
