/** Imports between the page's modules run one way: no module imports itself through others. */

import { existsSync, readdirSync, readFileSync } from "node:fs";
import { dirname, join, resolve } from "node:path";

const SOURCES = resolve(import.meta.dirname, "../../web/src");

function modules(): string[] {
  const entries = readdirSync(SOURCES, { recursive: true, withFileTypes: true });
  return entries.filter(({ name }) => /\.tsx?$/.test(name)).map(({ parentPath, name }) => join(parentPath, name));
}

function importsOf(module: string): string[] {
  const named = [...readFileSync(module, "utf8").matchAll(/from "(\.[^"]+)"/g)].map(([, path]) =>
    resolve(dirname(module), path ?? ""),
  );
  return named.flatMap((path) => [".ts", ".tsx", ".d.ts"].map((ending) => path + ending)).filter(existsSync);
}

/** The modules from which a search of imports comes back to one on its way; empty for none. */
function circle(): string[] {
  const done = new Set<string>();
  const visit = (module: string, path: readonly string[]): string[] => {
    if (path.includes(module)) return [...path.slice(path.indexOf(module)), module];
    if (done.has(module)) return [];
    for (const imported of importsOf(module)) {
      const loop = visit(imported, [...path, module]);
      if (loop.length > 0) return loop;
    }
    done.add(module);
    return [];
  };
  for (const module of modules()) {
    const loop = visit(module, []);
    if (loop.length > 0) return loop.map((path) => path.slice(SOURCES.length + 1));
  }
  return [];
}

it("no module of the page imports itself through others", () => {
  expect(modules().length).toBeGreaterThan(50);
  expect(circle()).toEqual([]);
});
