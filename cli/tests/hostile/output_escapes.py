# Writes sequences that steer terminals, then fails with more of them.
# expect: error "the program ended (exit code 1)"
import sys
import hrdsl
node = hrdsl.Node('robot')
print('\x1b[2J\x1b]0;mine\x07\x9b31m\u202e')
sys.exit('\x1b[31mred\x1b]52;c;AAAA\x07 \x00 \ufffe ]]> <script>')
