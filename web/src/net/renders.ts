/** Renders at the service. */

import type { Client } from "openapi-fetch";
import type { Render, RenderAction, RenderPage, RenderPlan, RenderRequest, RenderTask } from "../model/renders";
import { done, result } from "./answers";
import { abortable } from "./queries";
import type { paths } from "./schema";

export type ReportFormat = "csv" | "json" | "html";

/** Log of an attempt at a frame. */
export interface FrameLogText {
  readonly text: string;
  /** Whether no line follows. */
  readonly hasEnded: boolean;
}

export interface RenderService {
  /** Renders of the project, the newest first, or those older than one. */
  list(most: number, before: string | null): Promise<RenderPage>;
  /** What a render would be; sends nothing. */
  plan(request: RenderRequest, signal?: AbortSignal): Promise<RenderPlan>;
  /** Sends a render; the same key gives the same one. */
  send(request: RenderRequest, key: string): Promise<Render>;
  /** Changes a render; null where it is removed. */
  act(render: string, action: RenderAction): Promise<Render | null>;
  /** The frames of a render, in rising order. */
  tasks(render: string): Promise<readonly RenderTask[]>;
  /** The log of an attempt at a frame. */
  log(render: string, frame: number, attempt: number, signal?: AbortSignal): Promise<FrameLogText>;
  /** Address of a frame that is drawn, in a format of its render. */
  frameAddress(render: string, frame: number, format: string): string;
  /** Address of a small picture of a frame that is drawn. */
  thumbnailAddress(render: string, frame: number): string;
  /** Follows what the service tells of renders and their frames. */
  changes(): EventSource;
  /** Address of a product of a render, such as "movie.mp4". */
  productAddress(render: string, product: string): string;
  /** Address of the report of how sharp each focus point is in each frame. */
  reportAddress(render: string, format: ReportFormat): string;
}

export class HttpRenders implements RenderService {
  readonly #client: Client<paths>;
  readonly #base: string;

  constructor(client: Client<paths>, base: string) {
    [this.#client, this.#base] = [client, base];
  }

  list(most: number, before: string | null): Promise<RenderPage> {
    const query = { most, ...(before !== null && { before }) };
    return result(this.#client.GET("/v1/renders", { params: { query } }));
  }

  plan(request: RenderRequest, signal?: AbortSignal): Promise<RenderPlan> {
    return result(this.#client.POST("/v1/render-plans", { body: request, ...abortable(signal) }));
  }

  send(request: RenderRequest, key: string): Promise<Render> {
    const params = { header: { "idempotency-key": key } };
    return result(this.#client.POST("/v1/renders", { params, body: request }));
  }

  async act(render: string, action: RenderAction): Promise<Render | null> {
    const options = { params: { path: { render } } };
    if (action === "remove") {
      await done(this.#client.DELETE("/v1/renders/{render}", options));
      return null;
    }
    return result(this.#client.POST(`/v1/renders/{render}/${action}`, options));
  }

  async tasks(render: string): Promise<readonly RenderTask[]> {
    const { tasks } = await result(this.#client.GET("/v1/renders/{render}/tasks", { params: { path: { render } } }));
    return tasks;
  }

  async log(render: string, frame: number, attempt: number, signal?: AbortSignal): Promise<FrameLogText> {
    const params = { path: { render, frame }, query: { attempt } };
    const answer = this.#client.GET("/v1/renders/{render}/frames/{frame}/log", {
      params,
      parseAs: "text",
      ...abortable(signal),
    });
    const text = await result(answer);
    return { text, hasEnded: (await answer).response.headers.get("Pullfocus-Ended") === "true" };
  }

  frameAddress(render: string, frame: number, format: string): string {
    return `${this.#base}/v1/renders/${encodeURIComponent(render)}/frames/${frame}?format=${format}`;
  }

  thumbnailAddress(render: string, frame: number): string {
    return `${this.#base}/v1/renders/${encodeURIComponent(render)}/frames/${frame}/thumbnail`;
  }

  changes(): EventSource {
    return new EventSource(`${this.#base}/v1/events?topic=renders&topic=tasks`);
  }

  productAddress(render: string, product: string): string {
    const [kind = "", format = ""] = product.split(".");
    const query = kind === "contact-sheet" ? "" : `?format=${format}`; // which is a PNG always
    return `${this.#base}/v1/renders/${encodeURIComponent(render)}/${kind}${query}`;
  }

  reportAddress(render: string, format: ReportFormat): string {
    return `${this.#base}/v1/renders/${encodeURIComponent(render)}/focus-report?format=${format}`;
  }
}
