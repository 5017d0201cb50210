"""Sending of one message to the receiver of a webhook: signed, over a new connection to an address that was checked."""

from __future__ import annotations

import asyncio
import hashlib
import hmac
import ssl
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from http.cookiejar import CookieJar, DefaultCookiePolicy

import httpx

from service.http.receiver_addresses import Address, AddressError, LookUp, addresses_of, look_up

WITHIN_S = 10.0
"""Time for a whole delivery: look-up, connection and answer."""
MAX_ANSWER = 1024
"""Bytes of an answer that are read."""
DELIVERY_HEADER = "Pullfocus-Delivery"


@dataclass(frozen=True)
class Message:
    """Message to a receiver.

    Attributes:
        kind: what is told.
        delivery: the same for each try of one delivery.
        body: JSON.
    """

    kind: str
    delivery: str
    body: str


@dataclass(frozen=True)
class Answer:
    """Answer of a receiver.

    Attributes:
        outcome: `delivered`, `gone` (it wants no more), `refused` (its address may not be reached) or `failed`.
        status: of HTTP; None where it did not answer.
        text: the beginning of its body.
        error: why nothing was delivered; None where it was.
    """

    outcome: str
    status: int | None = None
    text: str = ""
    error: str | None = None


class Sender:
    """Sends messages. Used in the event loop of a service.

    Args:
        allows_private: whether receivers on this machine and in private networks may be reached.
        count: is called with the outcome of each try.
        look_up: returns the addresses of a host and a port.
        clock: tells the time that signatures have, s since 1970.
    """

    def __init__(
        self,
        allows_private: bool,
        count: Callable[[str], None],
        look_up: LookUp = look_up,
        clock: Callable[[], float] = time.time,
    ) -> None:
        self._allows_private = allows_private
        self._count = count
        self._look_up = look_up
        self._clock = clock

    @cached_property
    def _client(self) -> httpx.AsyncClient:
        """The client; a service without webhooks makes none, which takes time."""
        return httpx.AsyncClient(
            trust_env=False,  # a proxy would look the name up again
            verify=ssl.create_default_context(),  # the certificates that this machine trusts
            timeout=WITHIN_S,
            # A connection belongs to an address, and names of several receivers may lead to it: none is used again.
            limits=httpx.Limits(max_keepalive_connections=0),
            cookies=CookieJar(DefaultCookiePolicy(allowed_domains=())),
            headers={"User-Agent": "Pullfocus", "Accept-Encoding": "identity"},
        )

    async def close(self) -> None:
        """Close the connections."""
        if "_client" in vars(self):
            await self._client.aclose()

    async def send(self, url: str, secret: str, message: Message) -> Answer:
        """Send a message once.

        Args:
            url: of the receiver.
            secret: that the message is signed with.
            message: to be sent.
        """
        try:
            async with asyncio.timeout(WITHIN_S):
                answer = await self._post(httpx.URL(url), secret, message)
        except AddressError as error:
            answer = Answer("refused", error=str(error))
        except (TimeoutError, httpx.TimeoutException):
            answer = Answer("failed", error=f"the receiver did not answer within {WITHIN_S:g} s")
        except (httpx.HTTPError, httpx.InvalidURL, OSError, ValueError) as error:
            answer = Answer("failed", error=f"the receiver cannot be reached: {error or type(error).__name__}")
        self._count(answer.outcome)
        return answer

    async def _post(self, url: httpx.URL, secret: str, message: Message) -> Answer:
        *others, last = await addresses_of(url, self._look_up, allows_private=self._allows_private)
        connect_s = WITHIN_S / (len(others) + 1)
        for address in others:
            try:
                return await self._post_to(address, connect_s, url, secret, message)
            except (httpx.ConnectError, httpx.ConnectTimeout):
                continue
        return await self._post_to(last, connect_s, url, secret, message)

    async def _post_to(
        self, address: Address, connect_s: float, url: httpx.URL, secret: str, message: Message
    ) -> Answer:
        """Send a message to an address; the receiver is asked for, and checked, by the name of its URL."""
        body = message.body.encode()
        headers = {
            "Host": url.netloc.decode("ascii"),
            "Content-Type": "application/json",
            "Pullfocus-Event": message.kind,
            DELIVERY_HEADER: message.delivery,
            "Pullfocus-Signature": signature(secret, int(self._clock()), body),
        }
        request = self._client.build_request(
            "POST",
            url.copy_with(host=str(address)),
            content=body,
            headers=headers,
            timeout=httpx.Timeout(WITHIN_S, connect=connect_s),
            extensions={"sni_hostname": url.raw_host.decode("ascii")},
        )
        response = await self._client.send(request, stream=True)
        try:
            content = b""
            async for part in response.aiter_raw():
                content += part
                if len(content) >= MAX_ANSWER:
                    break
        finally:
            await response.aclose()
        text = content[:MAX_ANSWER].decode(errors="replace")
        if response.is_success:
            return Answer("delivered", response.status_code, text)
        error = f"the receiver answered with status {response.status_code}"
        return Answer("gone" if response.status_code == 410 else "failed", response.status_code, text, error)


def signature(secret: str, at: int, body: bytes) -> str:
    """Return the signature of a body.

    Args:
        secret: of the webhook.
        at: time of the try, s since 1970; it is signed, too, so that receivers can refuse old messages.
        body: of the message.
    """
    digest = hmac.new(secret.encode(), f"{at}.".encode() + body, hashlib.sha256).hexdigest()
    return f"t={at},v1={digest}"
