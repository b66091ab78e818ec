"""What all tests begin with."""

import signal

# A shell lets what it runs in the background ignore it, and Python then would: tests of Ctrl-C did not end.
signal.signal(signal.SIGINT, signal.default_int_handler)
