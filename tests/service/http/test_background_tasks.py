"""Work that is claimed in the background."""

from __future__ import annotations

import asyncio
import logging
import threading

import pytest

from service.http.background_tasks import claim_work

log = logging.getLogger("pullfocus.service")


@pytest.mark.parametrize("is_broken", [False, True], ids=["given_back", "cannot_be_given_back"])
def test_what_is_claimed_while_stopping_is_given_back(is_broken, caplog):
    begun, may_end, given_back = threading.Event(), threading.Event(), []

    def claim() -> str:
        begun.set()
        may_end.wait()
        return "frame 1"

    def give_back(claimed: str) -> None:
        given_back.append(claimed)
        if is_broken:
            raise ValueError("the database is gone")

    async def stop_meanwhile() -> None:
        claiming = asyncio.create_task(claim_work(claim, give_back, log))
        await asyncio.to_thread(begun.wait)
        claiming.cancel()
        await asyncio.sleep(0)
        may_end.set()
        with pytest.raises(asyncio.CancelledError):
            await claiming

    asyncio.run(stop_meanwhile())
    assert given_back == ["frame 1"]
    assert ("cannot be given back" in caplog.text) == is_broken


def test_what_is_claimed_is_returned():
    assert asyncio.run(claim_work(lambda: "frame 1", pytest.fail, log)) == "frame 1"
    assert asyncio.run(claim_work(lambda: None, pytest.fail, log)) is None
