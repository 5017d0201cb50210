"""The models of the client are those of the OpenAPI document."""

from __future__ import annotations

from pathlib import Path

from service.client import ENDED
from service.http.client_models import client_models

FILE = Path(__file__).parents[3] / "service" / "client" / "models.py"


def test_the_models_are_up_to_date():
    """``python -m service.http.client_models > service/client/models.py`` writes them."""
    assert FILE.read_text(encoding="utf-8") == client_models()


def test_the_states_of_an_end_are_states():
    text = FILE.read_text(encoding="utf-8")
    assert all(f"`{state}`" in text for state in ENDED)
