#!/bin/bash
# A shell that floods.
# expect: error "bytes of output"
yes
