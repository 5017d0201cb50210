/** A session with focus points, for tests of what is done with them. */

import { signal } from "@preact/signals";
import { Session } from "@/editor/session";
import { FakeService, SHOT, turn } from "./fake_service";
import { point } from "./points";

/** A session with two points, of which the second is selected, and a picture on screen. */
export async function opened(): Promise<{ fake: FakeService; session: Session; failed: unknown[] }> {
  const fake = new FakeService();
  const failed: unknown[] = [];
  fake.points = [point("near"), point("far")];
  const rights = { noEdits: signal(null), noPictures: signal(null) };
  const session = new Session(fake.service, SHOT, "/cam", 1, (error) => failed.push(error), rights);
  session.box.value = { width: 800, height: 400 };
  session.selected.value = "far";
  await turn();
  return { fake, session, failed };
}
