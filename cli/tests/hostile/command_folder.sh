#!/bin/bash
# A command that is a folder.
# expect: error "cannot start the program"
# run: /usr
