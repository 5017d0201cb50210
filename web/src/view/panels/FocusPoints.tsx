/** The list of focus points: what each asks for at this time, its keys, and where it is. */

import type { JSX, RefObject } from "preact";
import { useEffect, useLayoutEffect, useRef } from "preact/hooks";
import type { Editor } from "../../editor/editor";
import type { Session } from "../../editor/session";
import { formatDistance, type LengthUnit } from "../../model/distance";
import { WEIGHTS } from "../../model/scale";
import { mayBe } from "../../model/key_lanes";
import { groupsOf, type PointGroup } from "../../model/groups";
import { holderOf } from "../../model/parts";
import { inFrame, type FocusPoint } from "../../model/shot";
import { useChosen } from "../controls/chosen";
import { Edits } from "../controls/Edits";
import { Field } from "../controls/Field";
import { Icon } from "../icons";
import { parseQuantity } from "../numbers";
import { KeyButton, PointSettings } from "./PointSettings";
import { PointVerdict } from "./PointVerdict";
import { Section } from "./Section";

export function FocusPoints({ editor, session }: { editor: Editor; session: Session }): JSX.Element {
  const points = session.document.points.value;
  return (
    <Section
      name="points"
      title="Focus points"
      aside={<span class="muted">{points.length > 0 ? points.length : ""}</span>}
    >
      {points.length === 0 && <p class="muted pad">None yet. Click on what must be sharp.</p>}
      {points.length > 0 && (
        // One list, so that a row stays what it is when its point comes into another group.
        <ul aria-label="Focus points">
          {groupsOf(points).flatMap((group) => [
            group.name !== "" && <GroupHead key={`group ${group.name}`} session={session} group={group} />,
            ...shownOf(session, group).map((point) => (
              <PointRow
                key={session.pointEdits.identityOf(point.name)}
                editor={editor}
                session={session}
                point={point}
              />
            )),
          ])}
        </ul>
      )}
    </Section>
  );
}

/** The points of a group that the list shows: of a folded one the selected point alone. */
function shownOf(session: Session, { name, points }: PointGroup): readonly FocusPoint[] {
  const isFolded = session.foldedGroups.value.has(name);
  return isFolded ? points.filter((point) => point.name === session.selected.value) : points;
}

interface GroupProps {
  readonly session: Session;
  readonly group: PointGroup;
}

/** The name of a group, which folds it, and the switch of its points. */
function GroupHead({ session, group }: GroupProps): JSX.Element {
  const { name, points } = group;
  const isFolded = session.foldedGroups.value.has(name);
  return (
    <li class="point-group">
      <Edits session={session}>
        <GroupSwitch session={session} group={group} />
      </Edits>
      <h3>
        <button
          type="button"
          class="fold"
          aria-expanded={!isFolded}
          onClick={() => {
            session.foldGroup(name, !isFolded);
          }}
        >
          {name}
        </button>
      </h3>
      <span class="muted">{points.length}</span>
    </li>
  );
}

/** Whether the points of a group count: all, none, or some of them. */
function GroupSwitch({ session, group: { name, points } }: GroupProps): JSX.Element {
  const box = useRef<HTMLInputElement>(null);
  const count = points.filter(({ settings }) => settings.enabled).length;
  useLayoutEffect(() => {
    // A click takes the mark away, also where its edit fails.
    if (box.current) box.current.indeterminate = count > 0 && count < points.length;
  });
  return (
    <input
      ref={box}
      type="checkbox"
      class="switch"
      checked={count === points.length}
      aria-label={`All of ${name} enabled`}
      title="Enable or disable all points of the group"
      onChange={() => {
        void session.pointEdits.setGroupEnabled(name, count < points.length);
      }}
    />
  );
}

interface RowProps {
  readonly editor: Editor;
  readonly session: Session;
  readonly point: FocusPoint;
}

/** An element that is scrolled to when it is wanted. */
function useScrolled<Shown extends HTMLElement>(isWanted: boolean): RefObject<Shown | null> {
  const ref = useRef<Shown>(null);
  useEffect(() => {
    if (isWanted) ref.current?.scrollIntoView({ block: "nearest" });
  }, [isWanted]);
  return ref;
}

/** Gives the keyboard back to what had it in an element that has moved in its list. */
function useKeptFocus({ current: element }: RefObject<HTMLElement | null>): void {
  const focused = element?.contains(document.activeElement) ? document.activeElement : null;
  useLayoutEffect(() => {
    if (focused instanceof HTMLElement && focused.isConnected && document.activeElement !== focused) focused.focus();
  });
}

/** Whether a point counts. */
function CountSwitch({ session, point }: { session: Session; point: FocusPoint }): JSX.Element {
  const { name, settings } = point;
  const [enabled, chosen] = useChosen(settings.enabled, session.document.fresh.value, session.playhead.time.value);
  return (
    <input
      type="checkbox"
      class="switch"
      checked={enabled}
      aria-label={`${name} enabled`}
      title="Enabled"
      onChange={() => {
        // Not as the box is: the same click selects the point, and that has drawn the box anew.
        chosen.choose(!enabled, session.pointEdits.setEnabled(point, !enabled), session.playhead.time.value);
      }}
    />
  );
}

function PointRow({ editor, session, point }: RowProps): JSX.Element {
  const { name, settings } = point;
  const selected = session.selected.value === name;
  // On a narrow page that would scroll all of it.
  const row = useScrolled<HTMLLIElement>(selected && !editor.layout.isNarrow.value);
  useKeptFocus(row);
  return (
    <li
      ref={row}
      data-color={point.color}
      data-group={point.group}
      class={`point${selected ? " selected" : ""}${settings.enabled ? "" : " off"}`}
      onClick={() => (session.selected.value = name)}
    >
      <div class="point-head">
        <Edits session={session}>
          <CountSwitch session={session} point={point} />
          <KeyButton session={session} point={point} attribute="enabled" />
        </Edits>
        <button
          type="button"
          class="point-name"
          aria-pressed={selected}
          title={point.part || point.anchor.target.join(" ")}
        >
          {name} <span class="muted">{where(point, editor.remembered.unit.value)}</span>
        </button>
        <Edits session={session}>
          <button
            type="button"
            class="button icon-only quiet"
            aria-label={`Pull focus to ${name} now`}
            title="Pull focus to it now (F)"
            onClick={() => {
              session.pullTo(point);
            }}
          >
            <Icon name="target" />
          </button>
          <button
            type="button"
            class="button icon-only quiet"
            aria-label={`Remove ${name}`}
            title="Remove (Delete)"
            onClick={(event) => {
              event.stopPropagation();
              void session.pointEdits.remove(point);
            }}
          >
            <Icon name="trash" />
          </button>
        </Edits>
      </div>
      <PointVerdict editor={editor} session={session} point={point} />
      <Edits session={session}>
        <Weight session={session} point={point} />
        {selected && <PointSettings session={session} point={point} />}
      </Edits>
    </li>
  );
}

function Weight({ session, point }: { session: Session; point: FocusPoint }): JSX.Element {
  return (
    <div class="point-weight">
      <KeyButton session={session} point={point} attribute="weight" />
      <Field
        label={`Weight of ${point.name}`}
        labelHidden
        value={point.settings.weight}
        scale={WEIGHTS}
        fresh={session.document.fresh.value}
        example="0.5"
        format={(value) => value.toFixed(2)}
        parse={(text) => {
          const weight = parseQuantity(text, "");
          return weight !== null && mayBe({ point: point.name, attribute: "weight" }, weight) ? weight : null;
        }}
        startDrag={() => session.dragPoint(`Weight of ${point.name}`, point, "weight")}
      />
    </div>
  );
}

function where(point: FocusPoint, unit: LengthUnit): string {
  const holder = holderOf(point);
  if (point.depthM === null) return `not on ${holder} now`;
  const follows = point.part === "" ? "" : `, follows ${holder}`;
  if (point.depthM <= 0) return `behind the camera${follows}`;
  return `${formatDistance(point.depthM, unit)}${inFrame(point) ? "" : ", out of frame"}${follows}`;
}
