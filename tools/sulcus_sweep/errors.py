"""What ends a sweep with one line."""

import contextlib
import sys


class InputError(Exception):
    """Bad usage or input: one line that says where, what was found and what is expected; status 2."""


class SweepError(Exception):
    """It failed while running; status 1."""


@contextlib.contextmanager
def one_line():
    """Ends the program with the line and the status of what is raised inside."""
    try:
        yield
    except InputError as error:
        print(f"sweep: {error}", file=sys.stderr)
        sys.exit(2)
    except (SweepError, OSError) as error:
        print(f"sweep: {error}", file=sys.stderr)
        sys.exit(1)
