"""A page's server that answers while a test asks."""

import contextlib
import threading

from rsym.output.design.serving import DesignServer


@contextlib.contextmanager
def served(shape, html, **options):
    with DesignServer(shape, html, **options) as server:
        thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.02})
        thread.start()
        try:
            yield server
        finally:
            server.shutdown()
            thread.join()
