/** Who is signed in, what they may do and until when; nothing on a service that needs no key. */

import type { JSX } from "preact";
import type { Editor } from "../editor/editor";
import { formatEnd, isPerson, projectsOf, rightsOf, usageOf, type Who } from "../model/identity";
import { Menu } from "./controls/Menu";
import { Icon } from "./icons";

export function Account({ editor }: { editor: Editor }): JSX.Element | null {
  const { identity } = editor;
  const who = identity.who.value;
  if (!who || !isPerson(who)) return null;
  return (
    <Menu
      name="account"
      label="Who is signed in"
      title={`Signed in as ${who.label}`}
      head={
        <>
          <Icon name="person" />
          <span class="account-name">{who.label}</span>
        </>
      }
      onOpen={() => void editor.attempt(() => identity.refresh())}
    >
      {(close) => (
        <>
          <Facts who={who} />
          <button
            type="button"
            onClick={() => {
              close();
              void editor.signOut();
            }}
          >
            Sign out
          </button>
        </>
      )}
    </Menu>
  );
}

function Facts({ who }: { who: Who }): JSX.Element {
  return (
    <dl class="account">
      <Fact name="Signed in" value={who.label} />
      <Fact name="May" value={rightsOf(who)} />
      <Fact name="Sees" value={projectsOf(who)} />
      {usageOf(who).map(({ name, value }) => (
        <Fact key={name} name={name} value={value} />
      ))}
      {who.endsAt !== null && <Fact name="Until" value={formatEnd(who.endsAt, new Date())} />}
    </dl>
  );
}

function Fact({ name, value }: { name: string; value: string }): JSX.Element {
  return (
    <div>
      <dt>{name}</dt>
      <dd>{value}</dd>
    </div>
  );
}
