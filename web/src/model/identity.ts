/** Who is signed in, and what they may do. */

import type { components } from "../net/schema";

export type Who = components["schemas"]["Who"];

export type Scope = "read" | "render" | "edit" | "admin";

/** Things that scopes allow, for sentences; in the order in which they are listed. */
const DOES: Readonly<Record<Scope, string>> = {
  read: "look at shots",
  render: "draw pictures",
  edit: "edit",
  admin: "administer",
};

/** Whether a service that needs keys knows who sends the requests; one that needs none takes everybody for the same. */
export function isPerson(who: Who): boolean {
  return who.id !== "anyone";
}

/** Whether two are the same person: a new key in place of a revoked one keeps its label. */
export function isSamePerson(one: Who, other: Who): boolean {
  return one.label === other.label && one.project === other.project;
}

/** Reason why somebody may not do something; null where they may. */
export function refusalOf(who: Who | null, scope: Scope): string | null {
  if (who === null || who.scopes.includes(scope)) return null;
  return `${who.label} may ${rightsOf(who)}, not ${DOES[scope]}.`;
}

/** What somebody may do, such as "look at shots and edit". */
export function rightsOf(who: Who): string {
  const rights = Object.entries(DOES).flatMap(([scope, does]) => (who.scopes.includes(scope) ? [does] : []));
  return rights.length > 1
    ? `${rights.slice(0, -1).join(", ")} and ${rights.at(-1) ?? ""}`
    : (rights[0] ?? "do nothing");
}

export function projectsOf({ project }: Who): string {
  return project === "*" ? "All projects" : `Project ${project}`;
}

/** What is used of each amount that is limited, for people. */
export function usageOf({ usage }: Who): { readonly name: string; readonly value: string }[] {
  if (!usage) return [];
  const amounts = [
    { name: "Shots", amount: usage.shots, unit: "" },
    { name: "Stored", amount: usage.storedMb, unit: " MiB" },
    { name: "Work today", amount: usage.cpuS, unit: " s" },
  ];
  return amounts.flatMap(({ name, amount, unit }) =>
    amount && amount.allowed !== null
      ? [
          {
            name,
            value: `${Math.ceil(amount.used).toLocaleString("en")} of ${amount.allowed.toLocaleString("en")}${unit}`,
          },
        ]
      : [],
  );
}

/** The id within the text of a key, by which a password manager tells keys apart; empty where the text is no key. */
export function keyIdOf(key: string): string {
  return /^\s*pf_([0-9a-f]+)_/.exec(key)?.[1] ?? "";
}

/** When something ends, for people: the time on the same day, else the date too. */
export function formatEnd(endsAt: string, now: Date, language?: string): string {
  const end = new Date(endsAt);
  const time = end.toLocaleTimeString(language, { hour: "2-digit", minute: "2-digit" });
  if (end.toDateString() === now.toDateString()) return time;
  const year = end.getFullYear() === now.getFullYear() ? {} : ({ year: "numeric" } as const);
  return `${end.toLocaleDateString(language, { day: "numeric", month: "short", ...year })}, ${time}`;
}
