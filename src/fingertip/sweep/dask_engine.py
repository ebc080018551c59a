"""The workers of a running Dask cluster, through `distributed`'s own executor."""

from __future__ import annotations

import asyncio
import logging
import socket
import time
from concurrent.futures import Executor
from typing import Any

from fingertip._version import __version__
from fingertip.errors import Issue, MissingLibraryError, SweepError

_PATIENCE_S = 4.0
"""How long a scheduler may take to answer, and the first worker to be there."""
_LOST_S = 10.0
"""How long a scheduler that was lost is looked for."""
_COUNT_EVERY_S = 2.0


class Cluster:
    """An engine (see `engines.Engine`) whose workers may be anywhere; Dask replaces those that are lost.

    Raises
    ------
    MissingLibraryError
        Without `distributed`.
    SweepError
        If nobody answers at the address, there is no worker, or a worker's fingertip is not this one.
    """

    def __init__(self, address: str) -> None:
        try:
            import dask
            import distributed
        except ImportError:
            raise MissingLibraryError(
                Issue("--cluster", "needs Dask's distributed; pip install 'fingertip[cluster]', or leave it out.")
            ) from None
        for name in ("distributed", "distributed.client"):  # what goes wrong is told in one sentence
            logging.getLogger(name).setLevel(logging.CRITICAL)
        _knock(address)
        try:
            asyncio.run(asyncio.wait_for(_greet(address), _PATIENCE_S))
            self._client = distributed.Client(address, timeout=_LOST_S, set_as_default=False)
        except (OSError, ValueError, EOFError, TimeoutError):
            raise _refused(f"what answers at {address} is no Dask scheduler; start dask scheduler there") from None
        self.what = f"workers of {address}"
        # The scheduler's setting; here it is known only if both are configured alike, as they are by default.
        self.tries = 1 + int(dask.config.get("distributed.scheduler.allowed-failures", 3))
        self._counted = (0, 0.0)
        try:
            self._meet(address)
        except BaseException:
            self.close()
            raise

    @property
    def workers(self) -> int:
        """Those connected now; a cluster may grow while it works."""
        count, counted_s = self._counted
        if time.monotonic() - counted_s > _COUNT_EVERY_S and self._client.status == "running":
            known = self._client.scheduler_info(n_workers=-1).get("workers", ())  # nothing, once it is gone
            count = max(1, len(known))
            self._counted = count, time.monotonic()
        return count

    def executor(self) -> Executor:
        """The cluster; it replaces workers by itself."""
        executor: Executor = self._client.get_executor(pure=False)
        return executor

    def suspects(self) -> None:
        """Dask tells which tasks were lost by itself."""
        return None

    def close(self) -> None:
        """Leave the cluster; what it still computes for us is dropped."""
        self._client.close()

    def _meet(self, address: str) -> None:
        """Wait for a worker, and ask all that are there for their version."""
        try:
            self._client.wait_for_workers(1, timeout=_PATIENCE_S)
        except TimeoutError:
            raise _refused(f"{address} has no workers; start some there with dask worker {address}") from None

        def version() -> str:
            # Sent along by value, for a worker may not have this module.
            import fingertip

            return fingertip.__version__

        found: dict[str, Any] = self._client.run(version, on_error="return")
        for worker, answer in sorted(found.items()):
            if answer != __version__:
                what = f"fingertip {answer}" if isinstance(answer, str) else f"no fingertip ({answer})"
                raise _refused(f"worker {worker} has {what}, this is {__version__}; install the same everywhere")


def _knock(address: str) -> None:
    """Refuse what is no address, or one at which nobody listens: Dask's own patience is long."""
    host, _, port = address.rpartition("://")[2].rpartition(":")
    if not host or not port.isdecimal():
        raise _refused(f"{address!r} is no address; write it as tcp://HOST:8786, as dask scheduler prints it")
    try:
        socket.create_connection((host.strip("[]"), int(port)), timeout=_PATIENCE_S).close()
    except (OSError, OverflowError, UnicodeError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise _refused(f"nobody answers at {address} ({reason}); start dask scheduler there") from None


async def _greet(address: str) -> None:
    """Ask who is there; `Client` itself waits for ever for a listener that says nothing, or is no scheduler."""
    from distributed.comm import connect

    comm = await connect(address)
    try:
        await comm.write({"op": "identity", "reply": True})
        if (await comm.read())["type"] != "Scheduler":
            raise ValueError(address)
    finally:
        comm.abort()


def _refused(sentence: str) -> SweepError:
    return SweepError(Issue("--cluster", f"{sentence}."))
