/** Who else looks at the open shot: their frames and cameras, and a way to each. */

import type { JSX } from "preact";
import { useEffect, useRef } from "preact/hooks";
import type { Editor } from "../../editor/editor";
import type { Session } from "../../editor/session";
import { goToOther } from "../../editor/viewers";
import { primName } from "../../model/shot";
import { formatFrame } from "../../model/time";
import type { Other } from "../../model/viewers";

export function Company({ editor, session }: { editor: Editor; session: Session }): JSX.Element | null {
  const others = session.pictures.others.value;
  const list = useRef<HTMLUListElement>(null);
  const { companyCalled } = editor;
  const isCalled = companyCalled.value;
  useEffect(() => {
    if (!isCalled) return;
    companyCalled.value = false;
    requestAnimationFrame(() => {
      list.current?.querySelector<HTMLElement>("button:not(:disabled)")?.focus(); // also where a drawer has just opened
    });
  }, [isCalled, companyCalled]);
  if (others.length === 0) return null;
  return (
    <section class="company" aria-label="Also here">
      <h3>Also here</h3>
      <ul ref={list}>
        {others.map((other) => (
          <Row key={other.id} editor={editor} session={session} other={other} />
        ))}
      </ul>
    </section>
  );
}

function Row({ editor, session, other }: { editor: Editor; session: Session; other: Other }): JSX.Element {
  const { label, initials, colour, camera, time } = other;
  const isElsewhere = camera !== null && camera !== session.camera;
  const frame = time === null ? "" : formatFrame(time);
  return (
    <li data-color={colour} data-other={label}>
      <span class={isElsewhere ? "initials elsewhere" : "initials"} aria-hidden="true">
        {initials}
      </span>
      <span class="who">
        <span class="name">{label}</span>
        <span class="muted" title={camera ?? undefined}>
          {time === null ? "opening it" : `Frame ${frame}`}
          {isElsewhere && ` · ${primName(camera)}`}
        </span>
      </span>
      <button
        type="button"
        class="button small"
        disabled={time === null}
        aria-label={`Go to the frame of ${label}`}
        title={isElsewhere ? "Go to their frame, and look through their camera" : "Go to their frame"}
        onClick={() => void goToOther(editor, other)}
      >
        Go to
      </button>
    </li>
  );
}
