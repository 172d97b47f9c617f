"""One table for each contest, at the end."""

import pytest
from contest import CONTESTS, Contest


@pytest.fixture
def contest(request):
    """A contest that is told of at the end, named by the docstring of the benchmark."""
    made = Contest(request.function.__doc__)
    request.config.stash.setdefault(CONTESTS, []).append(made)
    return made


def pytest_terminal_summary(terminalreporter, config):
    for made in config.stash.get(CONTESTS, []):
        terminalreporter.write_line("")
        for line in made.lines():
            terminalreporter.write_line(line)
