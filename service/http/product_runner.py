"""Has the products of renders made that these were sent with, such as movies, as the last part of their jobs."""

from __future__ import annotations

import asyncio
import logging
from functools import partial

from starlette.concurrency import run_in_threadpool

from render.errors import OutputError, PullfocusError
from service.hidden_folders import without_folders
from service.http.background_tasks import claim_work, keep_busy, wait_for
from service.http.clients import client_of_work
from service.http.errors import ServiceError
from service.http.product_making import find_product
from service.http.service import Service
from service.jobs.frame_work import may_pass
from service.jobs.product_queue import ProductClaim
from service.models.render_products import PRODUCTS
from service.storage.errors import UnavailableError
from service.workers.errors import QueueFullError, StoppingError, WorkerError
from service.workers.jobs import Client

log = logging.getLogger("pullfocus.service")

LEASE_S = 60.0
"""Time after which a service is taken for gone."""
HOLD_S = 5.0
"""Time between two looks at whether a product is still wanted, each of which extends the lease."""
PAUSE_S = 1.0
"""Longest time between two looks for products."""
BUSY_PAUSE_S = 15.0
"""Pause of a product that the service has no room for, or whose owner has used up the processor time of a day."""
MOST_MAKING = 2
"""Products that a service makes at a time; more of them wait for a worker in any case."""


async def make_products(service: Service) -> None:
    """Make the products of renders until the service stops."""
    await ProductRunner(service).run()


class ProductRunner:
    """Makes the products of renders.

    Args:
        service: whose renders they are.
    """

    def __init__(self, service: Service) -> None:
        self._service = service
        self._queue = service.renders.products
        self._making: dict[asyncio.Task[None], ProductClaim] = {}
        self._is_sure = False  # an earlier service may have left some

    async def run(self) -> None:
        """Make products until this is cancelled; what is made then is given back."""
        wake = self._service.products_wake
        await keep_busy(
            self._begin_one,
            partial(wait_for, wake, PAUSE_S),  # until a render is sent, or a frame or product has ended
            self._doubt,
            self._making.keys(),
            log=log,
            complaint="products of renders cannot be made now",
        )

    def _doubt(self) -> None:
        """Look for what is held and not made: it may be claimed by a commit whose answer was lost."""
        self._is_sure = False

    async def _begin_one(self) -> bool:
        """Begin the next product, if there is one and room for it. Returns whether it was so."""
        if not self._is_sure:
            await run_in_threadpool(self._queue.take_back_left, tuple(self._making.values()), LEASE_S)
            self._is_sure = True
        if len(self._making) >= MOST_MAKING:
            return False
        claim = await claim_work(partial(self._queue.claim, LEASE_S), self._queue.give_back, log)
        if claim is None:
            return False
        task = asyncio.create_task(_work_on(self._service, claim))
        self._making[task] = claim
        task.add_done_callback(self._end)
        return True

    def _end(self, task: asyncio.Task[None]) -> None:
        del self._making[task]
        self._service.products_wake.set()
        if not task.cancelled() and task.exception() is not None:
            self._is_sure = False
            log.error("what became of a product cannot be noted", exc_info=task.exception())


async def _work_on(service: Service, claim: ProductClaim) -> None:
    """Have a product made and note what became of it."""
    client_of_work.set(Client(claim.owner, claim.render))
    queue = service.renders.products
    making = asyncio.create_task(_make(service, claim))
    holding = asyncio.create_task(_hold(service, claim, making))
    try:
        size_bytes = await making
        await run_in_threadpool(queue.finish, claim, size_bytes)
    except asyncio.CancelledError:
        making.cancel()
        await asyncio.wait((making,))
        task = asyncio.current_task()
        if task is not None and task.cancelling():
            queue.give_back(claim)  # here, as nothing that is awaited may be finished before the service is
            raise
        await run_in_threadpool(queue.give_back, claim)  # the render was canceled
    except (UnavailableError, QueueFullError, StoppingError):
        await run_in_threadpool(queue.give_back, claim, BUSY_PAUSE_S)
    except (PullfocusError, WorkerError, ServiceError, OSError) as error:
        if _comes_too_early(error):
            await run_in_threadpool(queue.give_back, claim, BUSY_PAUSE_S)
            return
        log.warning("%s of render %s could not be made: %s", claim.name, claim.render, error)
        is_worth_it = not isinstance(error, ServiceError) and may_pass(error)
        await run_in_threadpool(queue.fail, claim, without_folders(_reason_of(error)), may_pass=is_worth_it)
    except Exception as error:
        log.exception("%s of render %s could not be made", claim.name, claim.render)
        await run_in_threadpool(queue.fail, claim, without_folders(repr(error)))
    finally:
        holding.cancel()


async def _make(service: Service, claim: ProductClaim) -> int:
    """Make a product and return the size of its file, bytes."""
    render = await run_in_threadpool(service.renders.get, claim.render)
    name = next(name for name in PRODUCTS if name == claim.name)
    product = await find_product(service, render, name)
    return product.path.stat().st_size


async def _hold(service: Service, claim: ProductClaim, making: asyncio.Task[int]) -> None:
    """Extend the lease of a product while it is made; stop that once nobody wants it."""
    while True:
        await asyncio.sleep(HOLD_S)
        try:
            is_wanted = await run_in_threadpool(service.renders.products.extend, claim, LEASE_S)
        except OutputError:
            log.exception("the lease of %s of render %s cannot be extended", claim.name, claim.render)
            continue
        if not is_wanted:
            making.cancel()
            return


def _comes_too_early(error: Exception) -> bool:
    """Return whether the owner has used up the processor time of a day, or frames are drawn again meanwhile."""
    return isinstance(error, ServiceError) and (error.status == 429 or error.code == "render_not_ended")


def _reason_of(error: Exception) -> str:
    return error.detail if isinstance(error, PullfocusError | ServiceError) else str(error)
