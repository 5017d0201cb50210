/** Asks for a key where the service needs one. The key goes to the service alone, which answers with a cookie; the page keeps neither. */

import type { JSX } from "preact";
import { useEffect, useRef, useState } from "preact/hooks";
import type { Editor } from "../../editor/editor";
import { isPerson, keyIdOf } from "../../model/identity";
import { useModal } from "../hooks";

export function SignIn({ editor }: { editor: Editor }): JSX.Element {
  const { identity } = editor;
  const asking = identity.asking.value;
  const isBack = identity.who.value !== null && isPerson(identity.who.value);
  const ref = useModal(asking);
  return (
    <dialog
      ref={ref}
      class="help sign-in"
      aria-labelledby="sign-in-title"
      aria-describedby="sign-in-why"
      onClose={() => {
        identity.dismiss();
      }}
    >
      <h2 id="sign-in-title">Sign in</h2>
      <p id="sign-in-why">
        {isBack
          ? "Your session has ended, or your key was revoked. Sign in, and the page goes on where it was."
          : "This service needs a key. Whoever runs it can give you one."}
      </p>
      {asking && <KeyForm editor={editor} />}
    </dialog>
  );
}

function KeyForm({ editor }: { editor: Editor }): JSX.Element {
  const { identity } = editor;
  const [key, setKey] = useState("");
  const field = useRef<HTMLInputElement>(null);
  const refusal = identity.refusal.value;
  const trying = identity.trying.value;
  useEffect(() => {
    if (refusal !== null) field.current?.select();
  }, [refusal]);
  return (
    <form
      onSubmit={(event) => {
        event.preventDefault();
        if (!trying) void identity.signIn(key);
      }}
    >
      <KeyName of={key} />
      <label>
        Key
        <input
          ref={field}
          class="text-field"
          type="password"
          name="password"
          autocomplete="current-password"
          required
          autofocus
          spellcheck={false}
          value={key}
          aria-invalid={refusal !== null}
          aria-describedby="sign-in-refusal"
          onInput={(event) => {
            setKey(event.currentTarget.value);
          }}
        />
      </label>
      <p id="sign-in-refusal" class="refusal" role="alert">
        {refusal}
      </p>
      <div class="dialog-foot">
        <button
          type="button"
          class="button"
          onClick={() => {
            identity.dismiss();
          }}
        >
          Not now
        </button>
        <button type="submit" class="button primary" disabled={trying}>
          {trying ? "Signing in…" : "Sign in"}
        </button>
      </div>
    </form>
  );
}

/** Name under which a password manager keeps a key: its public part. */
function KeyName({ of }: { of: string }): JSX.Element {
  return (
    <input
      class="visually-hidden"
      type="text"
      name="username"
      autocomplete="username"
      tabIndex={-1}
      aria-hidden="true"
      readOnly
      value={keyIdOf(of)}
    />
  );
}
