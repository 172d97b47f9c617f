"""The version that is installed; `pyproject.toml` is the one place that says it."""

from importlib.metadata import PackageNotFoundError, version

try:
    __version__ = version("rsym")
except PackageNotFoundError:  # a source tree on the path
    __version__ = "0+not.installed"
