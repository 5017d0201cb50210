/** Shot, camera and time in the page's address, so that a link opens them. */

export interface Address {
  readonly shot: string | null;
  readonly camera: string | null;
  readonly time: number | null;
}

export function readAddress(href: string): Address {
  const query = new URL(href).searchParams;
  const time = Number(query.get("time") ?? NaN);
  return { shot: query.get("shot"), camera: query.get("camera"), time: Number.isFinite(time) ? time : null };
}

/** The address relative to the page; prim paths keep their slashes. */
export function writeAddress(address: Address | null): string {
  if (!address?.shot) return "?";
  const query = new URLSearchParams({ shot: address.shot });
  if (address.camera !== null) query.set("camera", address.camera);
  if (address.time !== null) query.set("time", address.time.toString());
  return `?${query.toString().replaceAll("%2F", "/")}`;
}
