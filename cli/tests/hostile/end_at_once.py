# Ends without a word.
# expect: error "the program ended (exit code 4)"
import os
os._exit(4)
