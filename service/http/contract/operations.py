"""Comparison of two OpenAPI documents: the changes that break clients of the first one."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from service.http.contract.kinds import Json
from service.http.contract.schemas import UNKNOWN, Finding, SchemaComparison, Side

MESSAGES = "x-websocket-messages"
"""Member of the document that lists the schemas of messages of WebSockets, which OpenAPI does not describe."""
_METHODS = ("get", "put", "post", "delete", "options", "head", "patch", "trace")


def breaking_changes(before: Json, now: Json) -> dict[Finding, list[str]]:
    """Return the changes that break clients, each with the ids of the operations that it concerns.

    Args:
        before: the document that was promised.
        now: the present one.
    """
    comparison = _Comparison(before, now)
    found: dict[Finding, list[str]] = {}
    for operation, finding in comparison.findings():
        operations = found.setdefault(finding, [])
        if operation not in operations:
            operations.append(operation)
    return found


class _Comparison:
    """Compares two documents.

    Args:
        before: the document that was promised.
        now: the present one.
    """

    def __init__(self, before: Json, now: Json) -> None:
        self._before = before
        self._now = now
        schemas, schemas_now = (document.get("components", {}).get("schemas", {}) for document in (before, now))
        self._requests = SchemaComparison(schemas, schemas_now, Side.REQUEST)
        self._answers = SchemaComparison(schemas, schemas_now, Side.ANSWER)

    def findings(self) -> Iterator[tuple[str, Finding]]:
        """Yield each finding with the id of its operation."""
        for path, methods in self._before["paths"].items():
            methods_now = self._now["paths"].get(path, {})
            for finding in _others(methods, methods_now, _METHODS, path):
                yield path, finding
            for method, before in methods.items():
                if method in _METHODS:
                    title = f"{method.upper()} {path}"
                    for finding in self._compare_operations(before, methods_now.get(method), title):
                        yield before.get("operationId", title), finding
        for finding in self._compare_messages():
            yield "messages", finding
        for finding in self._compare_documents():
            yield "every operation", finding

    def _compare_operations(self, before: Json, now: Json | None, title: str) -> Iterator[Finding]:
        if now is None:
            yield Finding(title, "is removed")
            return
        if before.get("operationId") != now.get("operationId"):
            yield Finding(title, f"its operationId was {before.get('operationId')}, is {now.get('operationId')}")
        yield from self._compare_parameters(before.get("parameters", ()), now.get("parameters", ()))
        yield from self._compare_bodies(before.get("requestBody"), now.get("requestBody"))
        yield from self._compare_responses(before["responses"], now["responses"])
        yield from self._compare_security(before, now)
        handled = ("operationId", "parameters", "requestBody", "responses", "security", "deprecated")
        yield from _others(before, now, handled, title)

    def _compare_parameters(self, before: Sequence[Json], now: Sequence[Json]) -> Iterator[Finding]:
        old, new = ({_parameter_place(one): one for one in parameters} for parameters in (before, now))
        for place, parameter in old.items():
            if place not in new:
                yield Finding(place, "is removed")
                continue
            if new[place].get("required", False) and not parameter.get("required", False):
                yield Finding(place, "is required now")
            yield from self._requests.compare(parameter.get("schema", True), new[place].get("schema", True), place)
            yield from _others(parameter, new[place], ("name", "in", "required", "schema", "deprecated"), place)
        for place, parameter in new.items():
            if place not in old and parameter.get("required", False):
                yield Finding(place, "is new, and required")

    def _compare_bodies(self, before: Json | None, now: Json | None) -> Iterator[Finding]:
        if before is None or now is None:
            if before is not None:
                yield Finding("body", "is removed")
            elif now is not None and now.get("required", False):
                yield Finding("body", "is new, and required")
            return
        if now.get("required", False) and not before.get("required", False):
            yield Finding("body", "is required now")
        yield from self._compare_contents(self._requests, before, now, "body")
        yield from _others(before, now, ("content", "required"), "body")

    def _compare_responses(self, before: Mapping[str, Json], now: Mapping[str, Json]) -> Iterator[Finding]:
        for status, response in before.items():
            place = f"answer {status}"
            if status not in now:
                yield Finding(place, "is removed")
                continue
            yield from self._compare_contents(self._answers, response, now[status], place)
            for name in sorted(response.get("headers", {}).keys() - now[status].get("headers", {}).keys()):
                yield Finding(f"{place}, header `{name}`", "is removed")
            yield from _others(response, now[status], ("content", "headers", "links"), place)

    def _compare_contents(self, comparison: SchemaComparison, before: Json, now: Json, place: str) -> Iterator[Finding]:
        contents, contents_now = before.get("content", {}), now.get("content", {})
        for media_type, content in contents.items():
            if media_type not in contents_now:
                yield Finding(f"{place} as {media_type}", "is removed")
                continue
            present = contents_now[media_type]
            for keyword in ("schema", "itemSchema"):
                here = place if len(contents) == 1 else f"{place} as {media_type}"
                yield from comparison.compare(content.get(keyword, True), present.get(keyword, True), here)
            yield from _others(content, present, ("schema", "itemSchema"), f"{place} as {media_type}")

    def _compare_security(self, before: Json, now: Json) -> Iterator[Finding]:
        allowed = [_needs(one) for one in _alternatives(now, self._now)]
        for one in _alternatives(before, self._before):
            if not any(needs <= _needs(one) for needs in allowed):
                shown = ", ".join(f"`{scheme}` ({', '.join(scopes)})" for scheme, scopes in one.items()) or "no key"
                yield Finding("security", f"{shown} is not enough any longer")

    def _compare_messages(self) -> Iterator[Finding]:
        for sender, comparison in (("fromClient", self._requests), ("toClient", self._answers)):
            messages, messages_now = (_messages(document, sender) for document in (self._before, self._now))
            for name, message in messages.items():
                if name in messages_now:
                    yield from comparison.compare(message, messages_now[name], name)
                else:
                    yield Finding(f"message {name}", "is removed")

    def _compare_documents(self) -> Iterator[Finding]:
        """Compare what is neither an operation nor a schema."""
        yield from _others(self._before, self._now, ("paths", "components", "security", MESSAGES), "document")
        schemes, schemes_now = (
            document.get("components", {}).get("securitySchemes", {}) for document in (self._before, self._now)
        )
        for name, scheme in schemes.items():
            if name not in schemes_now:
                yield Finding(f"security scheme `{name}`", "is removed")
            elif scheme != schemes_now[name]:
                yield Finding(f"security scheme `{name}`", "has changed")


def _parameter_place(parameter: Json) -> str:
    place, name = parameter["in"], parameter["name"]
    return f"{place} `{name.lower() if place == 'header' else name}`"


def _alternatives(operation: Json, document: Json) -> Sequence[Mapping[str, Sequence[str]]]:
    """Return what lets a client in: one of some alternatives, each of which is schemes with scopes."""
    return operation.get("security", document.get("security", ())) or ({},)


def _needs(alternative: Mapping[str, Sequence[str]]) -> set[tuple[str, str]]:
    return {(scheme, scope) for scheme, scopes in alternative.items() for scope in ("", *scopes)}


def _messages(document: Json, sender: str) -> dict[str, Json]:
    messages: Sequence[Json] = document.get(MESSAGES, {}).get(sender, ())
    return {message["$ref"].rpartition("/")[2]: message for message in messages}


def _others(before: Json, now: Json, handled: Sequence[str], place: str) -> Iterator[Finding]:
    """Yield changes of members that are not compared, since they may break clients."""
    for member in sorted({*before, *now} - {*handled}):
        if before.get(member) != now.get(member):
            yield Finding(place, UNKNOWN.format(member))
