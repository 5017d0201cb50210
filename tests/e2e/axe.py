"""Violations that axe-core finds on a page."""

from __future__ import annotations

from pathlib import Path

from playwright.sync_api import Page

AXE = Path(__file__).parents[2] / "web/node_modules/axe-core/axe.min.js"
RULES = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"]


def violations(page: Page) -> list[str]:
    """Violations that axe-core finds on a page: the rule and the elements of each violation."""
    page.evaluate(AXE.read_text(encoding="utf-8"))
    found = page.evaluate(
        """(tags) => {
          for (const one of document.getAnimations())  // colours are checked after fades end
            if (one.effect?.getComputedTiming().endTime < Infinity) one.finish();
          return axe.run(document, { resultTypes: ["violations"], runOnly: { type: "tag", values: tags } });
        }""",
        RULES,
    )
    return [
        f"{rule['id']}: {rule['help']}: {[node['html'] for node in rule['nodes'][:3]]}" for rule in found["violations"]
    ]
