/** What is looked at, as the page's address says it, so that it can be sent to somebody. */

export interface Address {
  readonly shot: string | null;
  readonly camera: string | null;
  readonly time: number | null;
}

export function readAddress(href: string): Address {
  const said = new URL(href).searchParams;
  const time = Number(said.get("time") ?? NaN);
  return { shot: said.get("shot"), camera: said.get("camera"), time: Number.isFinite(time) ? time : null };
}

/** The address of what is looked at, relative to the page; prim paths keep their slashes. */
export function writeAddress(seen: Address | null): string {
  if (!seen?.shot) return "?";
  const said = new URLSearchParams({ shot: seen.shot });
  if (seen.camera !== null) said.set("camera", seen.camera);
  if (seen.time !== null) said.set("time", seen.time.toString());
  return `?${said.toString().replaceAll("%2F", "/")}`;
}
