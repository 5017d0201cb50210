/** The set from above, and the place of the camera, over REST. */

import type { Client } from "openapi-fetch";
import type { CameraPlace } from "../model/camera_place";
import type { Paths, TopView } from "../model/top_view";
import { result } from "./answers";
import { toCameraPlace, toTopView } from "./convert";
import { abortable, at } from "./queries";
import type { paths } from "./schema";
import type { FromAbove } from "./service";
import type { View } from "./view";

export class HttpFromAbove implements FromAbove {
  readonly #client: Client<paths>;

  constructor(client: Client<paths>) {
    this.#client = client;
  }

  async topView(view: View, time: number, signal?: AbortSignal): Promise<TopView> {
    const answer = this.#client.GET("/v1/shots/{shot}/top-view", { ...at(view, { time }), ...abortable(signal) });
    return toTopView(await result(answer));
  }

  async cameraPlace(view: View, time: number, signal?: AbortSignal): Promise<CameraPlace> {
    const answer = this.#client.GET("/v1/shots/{shot}/camera/place", { ...at(view, { time }), ...abortable(signal) });
    return toCameraPlace(await result(answer));
  }

  async paths(view: View, signal?: AbortSignal): Promise<Paths> {
    return result(this.#client.GET("/v1/shots/{shot}/paths", { ...at(view, {}), ...abortable(signal) }));
  }
}
