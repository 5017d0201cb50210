"""Places of live connections are shared: nobody can hold all of them."""

from __future__ import annotations

from contextlib import ExitStack

import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect

from service.http.live_places import LivePlace, LivePlaces
from service.http.settings import Settings
from tests.service.conftest import running


class Clients:
    """Clients who hold places of one service."""

    def __init__(self, most: int) -> None:
        self.places, self.stack, self.held = LivePlaces(most), ExitStack(), []

    def ask(self, client: str, times: int = 1) -> list[bool]:
        """Ask for places, and tell for each whether it was given."""
        asked = [self.stack.enter_context(self.places.hold(client)) for _ in range(times)]
        self.held += [place for place in asked if place is not None]
        return [place is not None for place in asked]

    def count(self, client: str) -> int:
        """Places that a client has kept."""
        return sum(place.client == client and not place.taken.is_set() for place in self.held)


@pytest.fixture
def clients():
    with (made := Clients(8)).stack:
        yield made


def test_one_client_may_have_all_places_while_nobody_else_asks(clients):
    assert clients.ask("a", 9) == [True] * 8 + [False]


def test_newcomers_take_equal_shares_from_who_has_all(clients):
    clients.ask("a", 8)
    assert clients.ask("b", 6) == [True] * 4 + [False] * 2
    assert (clients.count("a"), clients.count("b")) == (4, 4)
    assert clients.ask("c", 3) == [True, True, False]
    assert sorted(clients.count(name) for name in "abc") == [2, 3, 3]


def test_shares_settle_however_often_a_greedy_client_comes_back(clients):
    clients.ask("a", 8)
    clients.ask("b")
    assert clients.ask("a", 100) == [False] * 100
    assert (clients.count("a"), clients.count("b")) == (7, 1)


def test_the_newest_connection_is_taken(clients):
    clients.ask("a", 8)
    clients.ask("b")
    assert [place.taken.is_set() for place in clients.held[:8]] == [False] * 7 + [True]


def test_at_most_as_many_are_held_as_there_are_places(clients):
    for number in range(40):
        clients.ask(f"client {number % 11}", 3)
        assert len(clients.places) == min(8, 3 * number + 3)


def test_a_place_is_free_again_when_its_connection_ends(clients):
    clients.ask("a", 7)
    with clients.places.hold("b") as place:
        assert isinstance(place, LivePlace)
        assert clients.ask("a") == [False]
    assert clients.ask("a") == [True]


def test_a_service_without_places_gives_none():
    with LivePlaces(0).hold("a") as place:
        assert place is None


def test_another_key_gets_in_where_one_holds_all_connections(tmp_path):
    settings = Settings(data=tmp_path, demo=False, access="keys", max_viewers=4, requests_per_s=1000)
    with running(settings) as service, ExitStack() as stack:
        keys = service.app.state.identity.keys
        texts = [keys.create(name, frozenset({"render"}), "*")[1] for name in ("greedy", "modest")]
        address = str(service.client.base_url).replace("http", "ws")

        def watch(text: str):
            headers = {"Authorization": f"Bearer {text}"}
            return stack.enter_context(connect(f"{address}/v1/shots/none/live", additional_headers=headers))

        greedy = [watch(texts[0]) for _ in range(4)]
        modest = watch(texts[1])
        with pytest.raises(ConnectionClosed) as closed:
            greedy[3].recv(timeout=10)
        assert (closed.value.rcvd.code, closed.value.rcvd.reason[:6]) == (1013, "Others")
        modest.send('{"id": 1, "time": 1}')
        assert "shot_not_found" in modest.recv(timeout=10)
        with pytest.raises(InvalidStatus) as refused:
            watch(texts[0])
        assert refused.value.response.status_code == 503
