"""Hooks of schemathesis: its valid requests upload a stage, and name prims and attributes that this stage has.

Without these hooks, few links would be followed: generated files are no stages, and generated names name nothing. Requests that
are meant to be refused stay as they were generated.
"""

from typing import Any

import schemathesis

STAGE = """#usda 1.0
(
    defaultPrim = "World"
    startTimeCode = 1
    endTimeCode = 48
    metersPerUnit = 1
)
def Xform "World"
{
    def Camera "main_cam"
    {
        float focalLength = 35
        float focusDistance = 4
        float fStop = 2
        double3 xformOp:translate = (0, 0, 5)
        uniform token[] xformOpOrder = ["xformOp:translate"]
    }
    def Sphere "hero"
    {
    }
}
"""
BODIES: dict[str, dict[str, Any]] = {
    "createShot": {"file": STAGE},
    "edit": {"changes": [{"type": "setCamera", "values": {"focusDistanceM": 3}}]},
    "createFocusPoint": {"target": ["/World/hero"]},
    "setKey": {"time": 24, "value": 1},
    "createWebhook": {"url": "http://127.0.0.1:1/"},
}
QUERIES: dict[str, dict[str, Any]] = {
    "getFrame": {"time": 24, "width": 64, "height": 36, "rays": 2},
    "getFocusPoint": {"time": 24},
}
PATHS = {"setKey": {"attribute": "weight"}}


@schemathesis.hook
def before_call(context: Any, case: Any, kwargs: dict[str, Any]) -> None:
    """Replace what a valid request names by what exists."""
    name = case.operation.definition.raw.get("operationId")
    if case.meta is None or case.meta.generation.mode.value != "positive":
        return
    if name in BODIES:
        case.body = BODIES[name]
    if name in QUERIES:
        case.query = dict(QUERIES[name])
    if name in PATHS:
        case.path_parameters |= PATHS[name]
    if case.query:
        case.query.pop("camera", None)
    if case.headers:
        case.headers.pop("if-match", None)
