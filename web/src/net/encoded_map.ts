/** The parts of an encoded map: its head, and the bytes of its numbers. */

export interface EncodedMap<Head> {
  readonly head: Head;
  /** Differences along the rows: all first bytes, all second ones, and so on. */
  readonly bytes: Uint8Array;
}

/** Takes a map apart. @param data the length of its head, the head, and the compressed numbers. */
export async function openMap<Head>(data: ArrayBuffer): Promise<EncodedMap<Head>> {
  const end = 4 + new DataView(data).getUint32(0);
  const head = JSON.parse(new TextDecoder().decode(data.slice(4, end))) as Head;
  const inflated = new Blob([data.slice(end)]).stream().pipeThrough(new DecompressionStream("deflate"));
  return { head, bytes: new Uint8Array(await new Response(inflated).arrayBuffer()) };
}
