#!/bin/bash
# A shell that sleeps in a child.
# expect: error "it never spoke to the harness"
sleep 1000
