#!/bin/bash
# A shell that speaks the protocol, and answers.
# expect: pass
say() { echo "$1" >&"$HRDSL_REQUEST_FD"; read -r reply <&"$HRDSL_REPLY_FD"; }
say '{"request":"hello","version":1,"name":"robot"}'
say '{"request":"wait_for","events":["asked"]}'
say '{"request":"emit","event":"said","args":{"n":1}}'
say '{"request":"done"}'
