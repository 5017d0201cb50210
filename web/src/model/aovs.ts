/** AOVs of a render's EXR files: declared ones are chosen, primvars are typed. */

import { AOVS, MOST_AOVS, PRIMVAR_PREFIX } from "./settings.gen";

export interface ChosenAovs {
  /** Names of declared AOVs. */
  readonly aovs: readonly string[];
  /** Names of primvars, with or without their prefix, between commas or spaces. */
  readonly primvars: string;
}

/** Names for the service: declared AOVs in the order of the files' parts, then primvars as they are typed; each once. */
export function aovsOf({ aovs, primvars }: ChosenAovs): readonly string[] {
  const declared = AOVS.map(({ name }) => name).filter((name) => aovs.includes(name));
  const typed = primvars.split(/[\s,]+/).filter((word) => word !== "");
  const named = typed.map((word) => (word.startsWith(PRIMVAR_PREFIX) ? word : `${PRIMVAR_PREFIX}${word}`));
  return [...new Set([...declared, ...named])];
}

/** What is wrong with chosen AOVs; null where nothing is. */
export function faultOfAovs(chosen: ChosenAovs): string | null {
  const names = aovsOf(chosen);
  if (names.includes(PRIMVAR_PREFIX)) return `Type a name behind ${PRIMVAR_PREFIX}, such as ${PRIMVAR_PREFIX}st.`;
  return names.length > MOST_AOVS ? `A render has ${MOST_AOVS} AOVs at most.` : null;
}

/** Chosen AOVs of names between commas; unknown ones are left out. */
export function chosenAovs(words: string): ChosenAovs {
  const names = words.split(",");
  return {
    aovs: names.filter((name) => AOVS.some((aov) => aov.name === name)),
    primvars: names.filter((name) => name.startsWith(PRIMVAR_PREFIX)).join(", "),
  };
}
