"""Validators of the schemas, registered with UsdValidation from Python, so that any UsdValidation client runs them.

Each rule is one validator, ``pullfocus:<Rule>``, with the keyword ``pullfocus`` and one error of the rule's name.
`validate` runs them all and `fix` repairs where that is safe. Importing this module registers them.
"""

from __future__ import annotations

from dataclasses import dataclass

from pxr import Sdf, Usd, UsdValidation

from usd_schemas.validation.camera_rules import CAMERA_RULES
from usd_schemas.validation.focus_rules import FOCUS_RULES
from usd_schemas.validation.key_rules import KEY_RULES
from usd_schemas.validation.layer_rules import LAYER_RULES
from usd_schemas.validation.rule import Fault, Fix, Rule, Severity

__all__ = ["KEYWORD", "RULES", "Fault", "Fix", "Problem", "Rule", "Severity", "fix", "validate"]

KEYWORD = "pullfocus"
RULES: tuple[Rule, ...] = (*CAMERA_RULES, *FOCUS_RULES, *KEY_RULES, *LAYER_RULES)
_BY_NAME = {rule.name: rule for rule in RULES}


@dataclass(frozen=True)
class Problem:
    """Problem that a validator reports.

    Attributes:
        rule: name of the rule.
        severity: error or warning.
        path: the prim or property.
        message: one sentence.
        fix: what `fix` would do about it in the stage's edit target, empty where nothing is safe.
    """

    rule: str
    severity: Severity
    path: str
    message: str
    fix: str = ""


def validate(stage: Usd.Stage) -> list[Problem]:
    """Run all rules on a stage; problems come in order of path and rule."""
    problems = []
    for error in UsdValidation.ValidationContext(keywords=[KEYWORD]).Validate(stage):
        rule, path = _BY_NAME[error.GetName()], _site_path(error)
        repair = rule.fix if rule.fix and rule.fix.possible(stage, path) else None
        problems.append(
            Problem(rule.name, rule.severity, str(path), error.GetMessage(), repair.description if repair else "")
        )
    return sorted(problems, key=lambda problem: (problem.path, problem.rule, problem.message))


def fix(stage: Usd.Stage, problem: Problem) -> bool:
    """Repair a problem in the stage's edit target, if its rule has a fix that is possible there; nothing is saved.

    (UsdValidation's own ``ApplyFix`` does the same and then saves the layer, which an anonymous edit layer cannot be.)

    Returns:
        Whether it was repaired.
    """
    repair = _BY_NAME[problem.rule].fix
    path = Sdf.Path(problem.path)
    if repair is None or not repair.possible(stage, path):
        return False
    repair.apply(stage, path)
    return True


def _site_path(error: UsdValidation.ValidationError) -> Sdf.Path:
    site = error.GetSites()[0]
    return site.GetProperty().GetPath() if site.IsProperty() else site.GetPrim().GetPath()


def _register(rule: Rule) -> None:
    kinds = {"error": UsdValidation.ValidationErrorType.Error, "warning": UsdValidation.ValidationErrorType.Warn}

    def task(subject: Usd.Stage | Usd.Prim, _time_range: UsdValidation.ValidationTimeRange) -> list[object]:
        stage = subject if rule.subject == "stage" else subject.GetStage()
        return [
            UsdValidation.ValidationError(
                rule.name,
                kinds[rule.severity],
                [UsdValidation.ValidationErrorSite(stage, fault.path)],
                fault.message,
            )
            for fault in rule.check(subject)
        ]

    metadata = UsdValidation.ValidatorMetadata(
        name=f"{KEYWORD}:{rule.name}",
        doc=rule.doc,
        keywords=[KEYWORD],
        # Multiple-apply schemas never match here, so focus points are found through their camera.
        schemaTypes=["UsdGeomCamera"] if rule.subject == "camera" else [],
    )
    registry = UsdValidation.ValidationRegistry()
    fixers = [_fixer(rule, rule.fix)] if rule.fix else []
    if rule.subject == "stage":
        registry.RegisterStageValidator(metadata, task, fixers=fixers)
    else:
        registry.RegisterPrimValidator(metadata, task, fixers=fixers)


def _fixer(rule: Rule, repair: Fix) -> UsdValidation.ValidationFixer:
    def possible(error: UsdValidation.ValidationError, target: Usd.EditTarget, time: Usd.TimeCode) -> bool:
        stage = error.GetSites()[0].GetStage()
        with Usd.EditContext(stage, target):
            return repair.possible(stage, _site_path(error))

    def apply(error: UsdValidation.ValidationError, target: Usd.EditTarget, time: Usd.TimeCode) -> bool:
        stage = error.GetSites()[0].GetStage()
        with Usd.EditContext(stage, target):
            repair.apply(stage, _site_path(error))
        return True

    return UsdValidation.ValidationFixer(
        name=repair.name,
        description=repair.description,
        fixerImplFn=apply,
        canApplyFn=possible,
        keywords=[KEYWORD],
        errorName=rule.name,
    )


for _rule in RULES:
    _register(_rule)
